#include "tools/batch/cell_store.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "formats/bounded_json.h"
#include "lib/experiment/result_table.h"
#include "lib/image_io/atomic_file.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::int64_t kMostCells = 4096;
constexpr const char* kKeptLines = "kept.jsonl";

// "2:4000 5:96": samples taken, and the number of pieces that gave so many.
std::string counts_text(const std::vector<std::pair<int, long long>>& counts) {
  std::string text;
  for (const auto& [samples, pieces] : counts)
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", samples, pieces);
  return text;
}

// What is no such text counts as not known.
std::vector<std::pair<int, long long>> counts_of(const std::string& text) {
  std::vector<std::pair<int, long long>> counts;
  std::istringstream words(text);
  int samples = 0;
  long long pieces = 0;
  char colon = 0;
  while (words >> samples >> colon >> pieces)
    counts.emplace_back(samples, pieces);
  const auto counted = [](const auto& count) { return count.first >= 0 && count.second > 0; };
  if (!words.eof() || !std::ranges::all_of(counts, counted)) counts.clear();
  return counts;
}

// Four digits: a spread is known to one or two.
ordered_json halves_json(const HalfDifference& difference) {
  std::string cells;
  for (const double cell : difference.cells)
    cells += fmt::format("{}{:.4g}", cells.empty() ? "" : " ", cell);
  return {{"columns", difference.columns},
          {"cells", std::move(cells)},
          {"varying", counts_text(difference.varying)}};
}

// What is no such object counts as not measured.
std::vector<MetricHalves> halves_of(const ordered_json& json) {
  std::vector<MetricHalves> list;
  if (!json.is_object()) return list;
  for (const auto& [metric, entry] : json.items()) {
    if (!entry.is_object() || !entry.contains("columns") || !entry["columns"].is_number_integer() ||
        !entry.contains("cells") || !entry["cells"].is_string() || !entry.contains("varying") ||
        !entry["varying"].is_string())
      return {};
    HalfDifference difference;
    std::istringstream words(entry["cells"].get<std::string>());
    for (double cell = 0.0; words >> cell;)
      difference.cells.push_back(cell);
    const auto columns = entry["columns"].get<std::int64_t>();
    const auto cells = static_cast<std::int64_t>(difference.cells.size());
    if (!words.eof() || columns < 1 || cells == 0 || cells > kMostCells || cells % columns != 0)
      return {};
    difference.columns = static_cast<int>(columns);
    difference.varying = counts_of(entry["varying"].get<std::string>());
    list.push_back({metric, std::move(difference)});
  }
  return list;
}

ordered_json to_json(const ResultRecord& record) {
  ordered_json json = {{"version", SPOOL_VERSION}, {"fields", ordered_json::object()}};
  for (std::size_t i = 0; i < record.fields.size(); ++i) {
    const ResultColumn& column = result_columns()[i];
    if (column.kind != ColumnKind::kCell && !record.fields[i].empty()) {
      json["fields"][column.name] = record.fields[i];
    }
  }
  if (!record.counts.empty()) json["counts"] = counts_text(record.counts);
  for (const MetricHalves& halves : record.halves)
    json["halves"][halves.metric] = halves_json(halves.difference);
  return json;
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
void fill(const ordered_json& fields, const ordered_json& spread, ResultRecord& record) {
  const std::vector<ResultColumn>& columns = result_columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].kind != ColumnKind::kCell) record.fields[i] = field_of(fields, columns[i].name);
  }
  if (const auto kept = spread.find("counts"); kept != spread.end() && kept->is_string())
    record.counts = counts_of(kept->get<std::string>());
  if (const auto kept = spread.find("halves"); kept != spread.end())
    record.halves = halves_of(*kept);
}

std::map<std::string, ordered_json> read_lines(const fs::path& path) {
  std::map<std::string, ordered_json> lines;
  std::ifstream file(path, std::ios::binary);
  for (std::string text; std::getline(file, text);) {
    auto json = format::parse_json<ordered_json>(text);
    if (!json.is_object()) continue;
    ResultRecord record;
    for (const ResultColumn& column : result_columns())
      record.fields.push_back(field_of(json, column.name));
    lines.try_emplace(key_of(record), std::move(json));
  }
  return lines;
}

bool is_failed(const fs::path& path) {
  const auto json = format::parse_json_file<ordered_json>(path);
  return json.is_discarded() || !json.contains("fields") || json["fields"].contains("error");
}

}  // namespace

CellStore::CellStore(fs::path folder) : folder_(std::move(folder)) {
  const fs::path lines = folder_ / kKeptLines;
  std::error_code status;
  if (fs::is_regular_file(lines, status))
    kept_ = std::make_shared<const std::map<std::string, ordered_json>>(read_lines(lines));
}

Result<void> CellStore::create() const {
  std::error_code status;
  fs::create_directories(cells(), status);
  if (status) return fail(ErrorCode::kIo, "{}: {}", cells().string(), status.message());
  return {};
}

bool CellStore::has_any() const {
  std::error_code status;
  return fs::is_directory(cells(), status);
}

Result<void> CellStore::remove_all() const {
  std::error_code status;
  fs::remove_all(cells(), status);
  if (status) return fail(ErrorCode::kIo, "{}: {}", cells().string(), status.message());
  return {};
}

Result<void> CellStore::write(const std::string& id, const ResultRecord& record) const {
  return write_text_file(
      path_of(id), to_json(record).dump(-1, ' ', false, ordered_json::error_handler_t::replace),
      true, true);
}

Result<ResultRecord> CellStore::read(const std::string& id, const Cell& cell) const {
  CellResult empty;
  empty.cell = cell;
  ResultRecord record;
  for (const ResultColumn& column : result_columns())
    record.fields.push_back(column.kind == ColumnKind::kCell ? column.text(empty) : "");
  const fs::path path = path_of(id);
  std::error_code status;
  if (!fs::is_regular_file(path, status)) {
    if (kept_) return kept_record(std::move(record));
    return fail(ErrorCode::kIo, "{}: not finished yet", path.string());
  }
  const auto json = format::parse_json_file<ordered_json>(path);
  if (!json.is_object() || !json.contains("fields") || !json["fields"].is_object()) {
    return fail(ErrorCode::kData, "{}: is no result of a cell", path.string());
  }
  fill(json["fields"], json, record);
  return record;
}

Result<ResultRecord> CellStore::kept_record(ResultRecord record) const {
  const auto line = kept_->find(key_of(record));
  if (line == kept_->end()) {
    return fail(ErrorCode::kIo, "{}: not in it", (folder_ / kKeptLines).string());
  }
  fill(line->second, line->second, record);
  return record;
}

std::size_t CellStore::count_others(const std::function<bool(const std::string&)>& known) const {
  std::error_code status;
  std::size_t others = 0;
  for (const auto& entry : fs::directory_iterator(cells(), status)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".json" && !known(path.stem().string())) ++others;
  }
  return others;
}

Result<std::size_t> CellStore::take_from(const CellStore& other) const {
  std::error_code status;
  std::size_t taken = 0;
  for (const auto& entry : fs::directory_iterator(other.cells(), status)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".json") continue;
    const fs::path own = path_of(path.stem().string());
    std::error_code unreadable;
    if (fs::exists(own, unreadable) && !is_failed(own)) continue;
    const auto text = format::read_short_text(path);
    if (!text) {
      return fail(ErrorCode::kIo, "{}: cannot be read, or is no regular file: delete it",
                  path.string());
    }
    SPOOL_TRY(write_text_file(own, *text, true, true));
    ++taken;
  }
  if (status) {
    return fail(ErrorCode::kIo, "{}: {}: is it a folder of spool evaluate?", other.folder_.string(),
                status.message());
  }
  return taken;
}

}  // namespace spool::tools
