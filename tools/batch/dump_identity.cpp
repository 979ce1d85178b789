#include "tools/batch/dump_identity.h"

#include <map>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/interchange/sha256.h"
#include "lib/image_io/atomic_file.h"
#include "tools/batch/dump_meta.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// The file is as it was when this was written.
bool is_unchanged(const DumpIdentity& dump) {
  std::error_code size, time;
  const auto bytes = fs::file_size(dump.path, size);
  const auto modified = fs::last_write_time(dump.path, time).time_since_epoch().count();
  return !size && !time && bytes == dump.bytes && modified == dump.modified;
}

// Of the whole file, where it is not known.
void find_sha256(DumpIdentity& dump) {
  if (!dump.sha256.empty() || !is_unchanged(dump)) return;
  if (auto found = interchange::sha256_of(dump.path)) dump.sha256 = std::move(*found);
}

}  // namespace

bool same_recording(DumpIdentity a, DumpIdentity b) {
  if (!a.index_sha256.empty() && !b.index_sha256.empty()) return a.index_sha256 == b.index_sha256;
  find_sha256(a);
  find_sha256(b);
  return !a.sha256.empty() && a.sha256 == b.sha256;
}

std::string scene_name(const DumpIdentity& dump) {
  if (!is_unchanged(dump)) return "";
  const auto reader = format::SpoolReader::open(dump.path);
  if (!reader) return "";
  const ordered_json meta = merged_meta(*reader);
  if (!meta.is_object() || !meta.contains("scene")) return "";
  const ordered_json& scene = meta["scene"];
  const ordered_json& name = scene.is_object() && scene.contains("name") ? scene["name"] : scene;
  return name.is_string() ? name.get<std::string>() : "";
}

Result<std::vector<DumpIdentity>> known_dumps(const fs::path& folder) {
  const auto json = format::parse_json_file<ordered_json>(folder / "dumps.json");
  std::vector<DumpIdentity> dumps;
  if (!json.is_array()) return dumps;
  for (const auto& entry : json) {
    if (!entry.is_object()) continue;
    try {
      dumps.push_back({entry.value("path", ""), entry.value("bytes", std::uint64_t{0}),
                       entry.value("modified", std::int64_t{0}), entry.value("index_sha256", ""),
                       entry.value("sha256", ""), ""});
    } catch (const ordered_json::type_error&) {
      return fail(ErrorCode::kData,
                  "{}: entry {}: path, index_sha256 and sha256 are texts, bytes and modified "
                  "numbers: choose "
                  "another folder or give --force",
                  (folder / "dumps.json").string(), dumps.size() + 1);
    }
  }
  return dumps;
}

Result<std::vector<DumpIdentity>> identify_dumps(const std::vector<std::string>& dumps) {
  std::vector<DumpIdentity> identified;
  std::map<std::string, std::string> known;  // hash: recording
  for (const std::string& dump : dumps) {
    std::error_code status;
    DumpIdentity identity;
    identity.name = dump;
    identity.path = fs::absolute(dump).lexically_normal();
    identity.bytes = fs::file_size(dump, status);
    if (status) return fail(ErrorCode::kIo, "{}: {}", dump, status.message());
    identity.modified = fs::last_write_time(dump, status).time_since_epoch().count();
    SPOOL_ASSIGN(identity.index_sha256, interchange::index_sha256_of(dump));
    const auto [at, fresh] = known.try_emplace(identity.index_sha256, dump);
    if (!fresh) {
      return fail(ErrorCode::kUsage,
                  "{} and {}: are one recording, which cannot count twice: leave one out",
                  at->second, dump);
    }
    identified.push_back(std::move(identity));
  }
  return identified;
}

Result<void> check_same_dumps(const std::vector<DumpIdentity>& dumps, const fs::path& folder) {
  SPOOL_ASSIGN(const std::vector<DumpIdentity> known, known_dumps(folder));
  for (const DumpIdentity& dump : dumps) {
    for (const DumpIdentity& other : known) {
      if (other.path.filename() != dump.path.filename() || same_recording(dump, other)) continue;
      return fail(ErrorCode::kUsage,
                  "{}: is not the recording that the results in {} were made from: choose another "
                  "folder or give --force",
                  dump.path.string(), folder.string());
    }
  }
  return {};
}

Result<void> keep_identities(std::vector<DumpIdentity> dumps, const fs::path& folder) {
  SPOOL_ASSIGN(const std::vector<DumpIdentity> known, known_dumps(folder));
  ordered_json json = ordered_json::array();
  for (DumpIdentity& dump : dumps) {
    for (const DumpIdentity& other : known) {
      if (other.path == dump.path && other.bytes == dump.bytes && other.modified == dump.modified)
        dump.sha256 = other.sha256;
    }
    json.push_back({{"path", dump.path.string()},
                    {"bytes", dump.bytes},
                    {"modified", dump.modified},
                    {"index_sha256", dump.index_sha256}});
    if (!dump.sha256.empty()) json.back()["sha256"] = dump.sha256;
  }
  SPOOL_TRY(check_same_dumps(dumps, folder));
  return write_text_file(folder / "dumps.json",
                         json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n",
                         true, true);
}

}  // namespace spool::tools
