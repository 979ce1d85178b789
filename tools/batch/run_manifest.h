// manifest.json of an evaluation: with which command, program, options and machine, from which
// recordings.
#pragma once

#include <chrono>
#include <filesystem>
#include <set>
#include <vector>

#include "lib/core/error.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/run_request.h"

namespace spool::tools {

// Writes manifest.json of the run's folder (of a shard: manifest-shard-i-of-N.json): command,
// version, machine, started, seconds, the plan with every option of every method, and path, bytes
// and index hash of each recording. The manifest of a whole run also holds those of the shards in
// the folder.
Result<void> write_manifest(const RunRequest& request, const std::vector<DumpIdentity>& dumps,
                            std::chrono::system_clock::time_point started);

std::set<std::filesystem::path> shard_manifests(const std::filesystem::path& folder);

}  // namespace spool::tools
