// Several pass folders as one recording: do they belong together, in which order, are they whole.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/pass_manifest.h"
#include "lib/core/error.h"

namespace spool::format {

struct PassRecording {
  PassManifest manifest;            // of the first folder; passes and batches of all of them
  std::vector<std::string> others;  // JSON texts of the further folders' recordings
};

// Joins the folders in the order given; every file is verified (size, CRC-32).
// kUsage no folder; kData settings differ, samples occur twice, a sequence has a gap, only some
// passes know their film position, or batches of the reference have different sizes.
Result<PassRecording> read_pass_recording(const std::vector<std::filesystem::path>& folders);

// The `meta` of the recording: renderer, version, settings, seeds, mode, cost_per_sample, channels.
std::string recording_meta(const PassRecording& recording);

// Median CPU seconds (wall seconds where those were not measured) of a sample; 0 if unknown.
double cost_per_sample(const PassRecording& recording);

}  // namespace spool::format
