#include "formats/interchange/dump_plan.h"

#include "formats/interchange/sha256.h"

namespace spool::interchange {

Result<ForeignFile> identify(const format::FileHandle& file) {
  SPOOL_ASSIGN(const uint64_t bytes, file.size());
  SPOOL_ASSIGN(std::string hash, sha256_of(file));
  return ForeignFile{file.path().filename().string(), bytes, std::move(hash), file.path()};
}

nlohmann::json to_json(const ImportRecord& record, bool half) {
  nlohmann::json files = nlohmann::json::array();
  for (const ForeignFile& file : record.files)
    files.push_back({{"name", file.name}, {"bytes", file.bytes}, {"sha256", file.sha256}});
  nlohmann::json json = {
      {"format", record.format},   {"version", record.version},     {"files", files},
      {"options", record.options}, {"converted", record.converted}, {"dropped", record.dropped}};
  if (record.independent == "unknown")
    json["independent"] = "unknown";
  else
    json["independent"] = record.independent == "true";
  if (half) json["precision"] = "half";
  return json;
}

}  // namespace spool::interchange
