// Results that were kept as lines, DIR/kept.jsonl: each has columns of results.jsonl, and `counts`
// and `halves` as a cell has them.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "lib/experiment/result_record.h"

namespace spool::tools {

class KeptLines {
 public:
  // None where there is no such file. What is no line of a result is left out.
  static KeptLines read(const std::filesystem::path& path);

  // The record of the cell that the columns of `cell` say, wherever its recording lies; null when
  // there is no line of it.
  const ResultRecord* find(const ResultRecord& cell) const;

 private:
  std::shared_ptr<const std::map<std::string, ResultRecord>> lines_;
};

}  // namespace spool::tools
