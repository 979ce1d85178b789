#include "tools/batch/kept_lines.h"

#include <cstdint>
#include <fstream>
#include <utility>
#include <vector>

#include "formats/bounded_json.h"
#include "lib/experiment/result_table.h"
#include "tools/batch/cell_text.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// What is no such object counts as not measured.
std::vector<MetricHalves> halves_of(const ordered_json& json) {
  std::vector<MetricHalves> list;
  if (!json.is_object()) return list;
  for (const auto& [metric, entry] : json.items()) {
    const auto text_of = [&](const char* key) {
      return entry.is_object() && entry.contains(key) && entry[key].is_string()
                 ? entry[key].template get<std::string>()
                 : std::string();
    };
    MetricHalves halves{metric, {}};
    const bool counted =
        entry.is_object() && entry.contains("columns") && entry["columns"].is_number_integer();
    if (!counted || !read_halves(entry["columns"].template get<std::int64_t>(), text_of("cells"),
                                 text_of("varying"), halves.difference))
      return {};
    list.push_back(std::move(halves));
  }
  return list;
}

// Which cell a record is of, wherever its recording lies.
std::string key_of(const ResultRecord& record) {
  std::string key;
  for (const char* column : {"dump", "sampler", "filter"})
    key += record.text(column) + '\n';
  for (const char* column : {"spp", "replicate", "threads"})
    key += format_number(record.number(column)) + '\n';
  return key;
}

// As result_fields(): what is neither a number nor a text is an empty field.
std::string field_of(const ordered_json& fields, const std::string& column) {
  const auto found = fields.find(column);
  if (found == fields.end()) return {};
  if (found->is_string()) return found->get<std::string>();
  return found->is_number() ? found->dump() : std::string();
}

// All but the columns that say which cell it is.
void fill_from(const ordered_json& line, ResultRecord& record) {
  const std::vector<ResultColumn>& columns = result_columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].kind != ColumnKind::kCell) record.fields[i] = field_of(line, columns[i].name);
  }
  if (const auto kept = line.find("counts"); kept != line.end() && kept->is_string())
    record.counts = counts_of(kept->get<std::string>());
  if (const auto kept = line.find("halves"); kept != line.end()) record.halves = halves_of(*kept);
}

}  // namespace

KeptLines KeptLines::read(const fs::path& path) {
  KeptLines kept;
  std::error_code status;
  if (!fs::is_regular_file(path, status)) return kept;
  auto lines = std::make_shared<std::map<std::string, ordered_json>>();
  std::ifstream file(path, std::ios::binary);
  for (std::string text; std::getline(file, text);) {
    auto json = format::parse_json<ordered_json>(text);
    if (!json.is_object()) continue;
    ResultRecord record;
    for (const ResultColumn& column : result_columns())
      record.fields.push_back(field_of(json, column.name));
    lines->try_emplace(key_of(record), std::move(json));
  }
  kept.lines_ = std::move(lines);
  return kept;
}

bool KeptLines::fill(ResultRecord& record) const {
  if (!lines_) return false;
  const auto line = lines_->find(key_of(record));
  if (line == lines_->end()) return false;
  fill_from(line->second, record);
  return true;
}

}  // namespace spool::tools
