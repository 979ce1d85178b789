// `spool pack`: folders of recorded passes, or a foreign file, become one dump.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/interchange/expansion.h"
#include "formats/pass_folder.h"
#include "tools/console.h"

namespace spool::tools {

struct PackVerbOptions {
  std::vector<std::filesystem::path> sources;
  std::string from = "passes";  // or one of foreign_formats()
  std::filesystem::path output;
  format::PackOptions pack;
  // Of foreign files:
  bool exchangeable = false;           // the order of samples carries no meaning
  std::string layout;                  // npz without `meta`: HWSC or SHWC
  bool narrow = false;                 // npz: take 64-bit floats
  std::string sbmc_scale;              // sbmc: normalised or raw
  std::optional<uint64_t> frame;       // noisebase: of a sequence
  std::vector<std::string> layer_map;  // exr-folder: OURS=LAYER
  bool deep_samples = false;           // deep-exr: of another tool
  uint64_t max_expansion = interchange::Expansion{}.times;  // the dump against its source
};

// What --from takes besides "passes".
const std::vector<std::string>& foreign_formats();

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common);

}  // namespace spool::tools
