// Which recordings the results in a folder were made from: DIR/dumps.json, by the hash of each
// one's index, so that no job of many reads a recording for its identity.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

struct DumpIdentity {
  std::filesystem::path path;  // absolute
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  // of the file, in ticks of its clock
  std::string index_sha256;   // formats/interchange/sha256.h; empty: written by an older program
  std::string sha256;         // of the whole file, as older programs wrote it; empty: not known
  std::string name;           // as the plan or the command gave it; not stored
};

// Of each recording; kUsage when two are one.
Result<std::vector<DumpIdentity>> identify_dumps(const std::vector<std::string>& dumps);
// Whether two recordings are one: by their indices, else by their whole files, of which one that is
// not known is read where it lies unchanged.
bool same_recording(DumpIdentity a, DumpIdentity b);
// As the recording calls it; empty where it does not, or no longer lies unchanged.
std::string scene_name(const DumpIdentity& dump);
// Those of `folder`; empty where there is no dumps.json, kData where it has values of other types.
Result<std::vector<DumpIdentity>> known_dumps(const std::filesystem::path& folder);
// kUsage when `folder`, of results, names a recording of the same file name and other contents:
// results of the two must not be mixed.
Result<void> check_same_dumps(const std::vector<DumpIdentity>& dumps,
                              const std::filesystem::path& folder);
// The same, and dumps.json is written.
Result<void> keep_identities(std::vector<DumpIdentity> dumps, const std::filesystem::path& folder);

}  // namespace spool::tools
