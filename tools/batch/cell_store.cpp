#include "tools/batch/cell_store.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <optional>
#include <utility>

#include "formats/bounded_json.h"
#include "lib/experiment/result_table.h"
#include "lib/image_io/atomic_file.h"
#include "tools/batch/cell_text.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kKeptLines = "kept.jsonl";

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

// Without the columns that say which cell it is; nothing when the file is no cell's.
std::optional<ResultRecord> read_file(const fs::path& path) {
  const auto text = format::read_short_text(path);
  ResultRecord record;
  record.fields.resize(result_columns().size());
  if (!text || !read_cell_text(*text, record)) return std::nullopt;
  return record;
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
  return write_text_file(path_of(id), cell_text(record), true, true);
}

Result<ResultRecord> CellStore::read(const std::string& id, const Cell& cell) const {
  const fs::path path = path_of(id);
  std::optional<ResultRecord> found = read_file(path);
  ResultRecord record = found ? std::move(*found) : ResultRecord{};
  record.fields.resize(result_columns().size());
  CellResult empty;
  empty.cell = cell;
  for (std::size_t i = 0; i < result_columns().size(); ++i) {
    const ResultColumn& column = result_columns()[i];
    if (column.kind == ColumnKind::kCell) record.fields[i] = column.text(empty);
  }
  if (found) return record;
  std::error_code status;
  if (fs::is_regular_file(path, status))
    return fail(ErrorCode::kData, "{}: is no result of a cell", path.string());
  if (kept_) return kept_record(std::move(record));
  return fail(ErrorCode::kIo, "{}: not finished yet", path.string());
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
    if (fs::exists(own, unreadable)) {
      const std::optional<ResultRecord> kept = read_file(own);
      if (kept && !kept->failed()) continue;
    }
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
