#include "tools/batch/cell_store.h"

#include <algorithm>
#include <cstdint>
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

bool is_failed(const fs::path& path) {
  const auto json = format::parse_json_file<ordered_json>(path);
  return json.is_discarded() || !json.contains("fields") || json["fields"].contains("error");
}

}  // namespace

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
  const fs::path path = path_of(id);
  std::error_code status;
  if (!fs::is_regular_file(path, status)) {
    return fail(ErrorCode::kIo, "{}: not finished yet", path.string());
  }
  const auto json = format::parse_json_file<ordered_json>(path);
  const auto understood = [&] {
    return !json.is_discarded() && json.contains("fields") && json["fields"].is_object();
  };
  if (!understood()) return fail(ErrorCode::kData, "{}: is no result of a cell", path.string());
  CellResult empty;
  empty.cell = cell;
  ResultRecord record;
  for (const ResultColumn& column : result_columns()) {
    std::string field;
    if (column.kind == ColumnKind::kCell) {
      field = column.text(empty);
    } else if (const auto found = json["fields"].find(column.name);
               found != json["fields"].end() && found->is_string()) {
      field = found->get<std::string>();
    }
    record.fields.push_back(std::move(field));
  }
  if (const auto kept = json.find("counts"); kept != json.end() && kept->is_string()) {
    record.counts = counts_of(kept->get<std::string>());
  }
  if (const auto kept = json.find("halves"); kept != json.end()) record.halves = halves_of(*kept);
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
