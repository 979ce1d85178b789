// `spool reconstruct`: the statistics of a selection become an image.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/pool/sample_pool.h"
#include "tools/console.h"
#include "tools/methods/method_settings.h"

namespace spool::tools {

struct ReconstructOptions {
  std::filesystem::path dump;
  std::filesystem::path selection;  // empty: the first `spp` samples of every pixel
  int spp = 0;                      // 0: all
  std::string filter;
  MethodOptions method;
  PoolOptions pool;     // for selections that do not say theirs
  bool layers = false;  // also variance, filter size and direction
  std::string views;    // "f,d.2": intermediate images
  std::filesystem::path output;
  std::filesystem::path pictures;  // folder; empty: none
};

Result<void> run_reconstruct(const ReconstructOptions& options, const CommonOptions& common);

}  // namespace spool::tools
