// `meta.import` of a recording: which files it was made of, how, and what was converted or dropped.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

struct ForeignFile {
  std::string name;
  uint64_t bytes = 0;
  std::string sha256;
};

Result<ForeignFile> identify(const format::FileHandle& file);

// `independent`: "true", "false" or "unknown".
struct ImportRecord {
  std::string format;
  int version = 1;
  std::vector<ForeignFile> files;
  nlohmann::json options = nlohmann::json::object();
  std::vector<std::string> converted, dropped;
  std::string independent = "unknown";
};

// `half`: some numbers had 16 bits.
nlohmann::json to_json(const ImportRecord& record, bool half);

}  // namespace spool::interchange
