// `spool pixel`: what was recorded at a pixel: its samples in the order in which a replay takes
// them, their running mean with its interval, and a histogram of their luminance; how many of them
// a sampler takes, and with which weights a filter makes the pixel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lib/pool/sample_pool.h"
#include "tools/methods/method_settings.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct PixelOptions {
  std::filesystem::path dump;
  std::vector<std::string> places;  // "X,Y"
  int samples = 0;                  // of each pixel, the first ones; 0: all
  PoolOptions pool;
  // Of an evaluation: the order in which its replicate 0 takes samples.
  std::optional<std::uint64_t> evaluation_seed;
  std::string sampler, filter;  // empty: none
  std::optional<double> spp;    // of the sampler
  MethodOptions method;
};

Result<void> validate(const PixelOptions& options);

Result<void> run_pixel(const PixelOptions& options, const CommonOptions& common);

}  // namespace spool::tools
