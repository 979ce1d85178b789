// Reads what a folder of recorded passes says about itself: manifest.json and passes.jsonl.
//
// The byte layout and the rules are dumps/passes.md. Nothing is believed: sizes are compared with
// the files, checksums with the bytes, before a sample is used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/record_layout.h"
#include "lib/core/error.h"

namespace spool::format {

struct PassChannel {
  std::string name;                    // "albedo.R"
  DataType type = DataType::kFloat32;  // how the recorder requires it stored
};

// One finished file: a pass of the pool, or a batch of the reference.
struct PassEntry {
  std::filesystem::path file;
  uint64_t index = 0;
  uint32_t crc32 = 0;
  bool packed = false;  // pieces compressed one by one (formats/pass_file.h)
  uint32_t seed = 0;
  uint64_t sample_index = 0;  // place in the sequence of its seed
  uint64_t samples = 1;       // samples averaged in the file: 1 in the pool
  double seconds = 0.0;       // wall time of its rendering; 0 not measured
  double cpu_seconds = 0.0;   // of all threads; 0 not measured
  bool has_film = false;
  float film_x = 0.0F;  // [0,1), y down
  float film_y = 0.0F;
  // Of a folded reference, one file for all its batches: their seeds, in order; empty otherwise.
  // Planes: mean R, G, B of `samples`, then the variance of that mean.
  std::vector<uint32_t> folded_seeds;
};

struct PassManifest {
  std::filesystem::path folder;
  std::string recording;  // JSON text of everything that must agree between folders
  uint32_t width = 0;
  uint32_t height = 0;
  std::string mode;                   // iid, shift, sequence
  std::vector<PassChannel> channels;  // radiance.R, .G, .B first
  std::vector<PassEntry> passes;      // by index
  std::vector<PassEntry> batches;     // by index; three channels each, radiance

  bool is_folded() const { return batches.size() == 1 && !batches[0].folded_seeds.empty(); }
  uint32_t batch_channels() const { return is_folded() ? 6 : 3; }
  std::vector<uint32_t> batch_seeds() const;  // in order
  uint64_t batch_samples() const;             // of each, all have as many
};

inline constexpr uint32_t kMaxPassSide = 65536;

// kIo missing or unreadable; kData not a pass folder, or one that breaks a rule. A torn last line
// of passes.jsonl (a killed recorder) is no line.
Result<PassManifest> read_pass_manifest(const std::filesystem::path& folder);

// The first key whose value differs, as "KEY: A there, B here"; empty if all agree. `seed` may
// differ.
std::string recording_difference(const std::string& there, const std::string& here);

}  // namespace spool::format
