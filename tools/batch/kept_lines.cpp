#include "tools/batch/kept_lines.h"

#include <fstream>
#include <utility>

#include "lib/experiment/result_table.h"
#include "tools/batch/cell_text.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

// Which cell a record is of, wherever its recording lies.
std::string key_of(const ResultRecord& record) {
  std::string key;
  for (const char* column : {"dump", "sampler", "filter"})
    key += record.text(column) + '\n';
  for (const char* column : {"spp", "replicate", "threads"})
    key += format_number(record.number(column)) + '\n';
  return key;
}

}  // namespace

KeptLines KeptLines::read(const fs::path& path) {
  KeptLines kept;
  std::error_code status;
  if (!fs::is_regular_file(path, status)) return kept;
  auto lines = std::make_shared<std::map<std::string, ResultRecord>>();
  std::ifstream file(path, std::ios::binary);
  for (std::string text; std::getline(file, text);) {
    ResultRecord record;
    if (!read_cell_text(text, record)) continue;
    std::string key = key_of(record);
    lines->try_emplace(std::move(key), std::move(record));
  }
  kept.lines_ = std::move(lines);
  return kept;
}

const ResultRecord* KeptLines::find(const ResultRecord& cell) const {
  if (!lines_) return nullptr;
  const auto line = lines_->find(key_of(cell));
  return line == lines_->end() ? nullptr : &line->second;
}

}  // namespace spool::tools
