// manifest.json of an evaluation: with which command, program and machine, from which recordings.
#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

struct RunManifest {
  std::vector<std::filesystem::path> dumps;
  std::chrono::system_clock::time_point started;
};

// Writes FOLDER/manifest.json: command, version, machine, started, seconds, and path, bytes and
// sha256 of each recording.
Result<void> write_manifest(const std::filesystem::path& folder, const RunManifest& run);

}  // namespace spool::tools
