// Results that were kept as lines, DIR/kept.jsonl: each has columns of results.jsonl, and `counts`
// and `halves` as a cell has them.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "lib/experiment/result_record.h"

namespace spool::tools {

class KeptLines {
 public:
  // None where there is no such file. What is no line of a result is left out.
  static KeptLines read(const std::filesystem::path& path);

  // Fills in all but the columns that say which cell it is, wherever its recording lies; false when
  // there is no line of it.
  bool fill(ResultRecord& record) const;

 private:
  std::shared_ptr<const std::map<std::string, nlohmann::ordered_json>> lines_;
};

}  // namespace spool::tools
