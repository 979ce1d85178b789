// manifest.json of an evaluation: with which command, program, options and machine, from which
// recordings.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "tools/batch/dump_identity.h"

namespace spool::tools {

struct RunManifest {
  std::vector<DumpIdentity> dumps;
  std::chrono::system_clock::time_point started;
  const Plan* plan = nullptr;
  std::string shard;  // "i/N", or empty
};

// Writes FOLDER/manifest.json (of a shard: manifest-shard-i-of-N.json): command, version, machine,
// started, seconds, the plan with every option of every method, and path, bytes and index hash of
// each recording. The manifest of a whole run also holds those of the shards in the folder.
Result<void> write_manifest(const std::filesystem::path& folder, const RunManifest& run);

}  // namespace spool::tools
