// `spool synth`: an analytic scene, sampled, with its exact reference, as a recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/terminal/console.h"

namespace spool::tools {

struct SynthOptions {
  std::string scene;
  std::string size = "128x128";  // "WxH" or "N"
  int spp = 64;
  std::uint64_t seed = 1;
  std::vector<std::string> settings;  // "OPTION=VALUE"
  bool compress = false;
  std::filesystem::path output;
};

Result<void> validate(const SynthOptions& options);

// The recording itself; nothing is printed.
Result<void> synthesise(const SynthOptions& options, bool force,
                        const std::function<void(double)>& progress);

Result<void> run_synth(const SynthOptions& options, const CommonOptions& common);

}  // namespace spool::tools
