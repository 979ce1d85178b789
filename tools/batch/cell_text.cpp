#include "tools/batch/cell_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "formats/bounded_json.h"
#include "formats/crc32.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/result_table.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr long long kMostCells = 4096;
constexpr std::string_view kChecksum = R"({"crc32":")", kCell = R"("cell":")";

std::string counts_text(const std::vector<std::pair<int, long long>>& counts) {
  std::string text;
  for (const auto& [samples, pieces] : counts)
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", samples, pieces);
  return text;
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

// The next number of the text, which is then shorter.
template <class Number>
std::optional<Number> next_number(std::string_view& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool skip(std::string_view& text, std::string_view start) {
  if (!text.starts_with(start)) return false;
  text.remove_prefix(start.size());
  return true;
}

template <class Number>
bool read_hexadecimal(std::string_view& text, std::size_t digits, Number& number) {
  if (text.size() < digits) return false;
  const char* end = text.data() + digits;
  if (std::from_chars(text.data(), end, number, 16).ptr != end) return false;
  text.remove_prefix(digits);
  return true;
}

std::uint32_t checksum_of(std::string_view text) {
  return format::crc32(std::as_bytes(std::span(text)));
}

std::optional<std::size_t> column_of(const std::string& name) {
  static const std::unordered_map<std::string, std::size_t> columns = [] {
    std::unordered_map<std::string, std::size_t> known;
    for (std::size_t i = 0; i < result_columns().size(); ++i)
      known.emplace(result_columns()[i].name, i);
    return known;
  }();
  const auto found = columns.find(name);
  return found == columns.end() ? std::nullopt : std::optional(found->second);
}

// "2:4000 5:96": samples taken, and the number of pieces that gave so many. What is no such text
// counts as not known.
std::vector<std::pair<int, long long>> counts_of(std::string_view text) {
  std::vector<std::pair<int, long long>> counts;
  while (!text.empty()) {
    if (!counts.empty() && !skip(text, " ")) return {};
    const auto samples = next_number<int>(text);
    if (!samples || *samples < 0 || !skip(text, ":")) return {};
    const auto pieces = next_number<long long>(text);
    if (!pieces || *pieces <= 0) return {};
    counts.emplace_back(*samples, *pieces);
  }
  return counts;
}

// Numbers between spaces, of one half's difference in each cell of the image; `columns` of them in
// a row. What is no such text counts as not measured.
bool read_halves(long long columns, std::string_view cells, std::string_view varying,
                 HalfDifference& difference) {
  while (!cells.empty()) {
    if (!difference.cells.empty() && !skip(cells, " ")) return false;
    const auto cell = next_number<double>(cells);
    if (!cell || !std::isfinite(*cell)) return false;
    difference.cells.push_back(*cell);
  }
  const auto count = static_cast<long long>(difference.cells.size());
  if (columns < 1 || count == 0 || count > kMostCells || count % columns != 0) return false;
  difference.columns = static_cast<int>(columns);
  difference.varying = counts_of(varying);
  return true;
}

// Takes the parts of the text as the parser comes to them. Fields are those of "fields", or of the
// object itself.
class CellReader {
 public:
  explicit CellReader(ResultRecord& record) : record_(record) {}

  bool has_fields() const { return has_fields_; }

  bool start_object(std::size_t) {
    ++depth_;
    if (depth_ == 3) columns_ = 0, cells_.clear(), varying_.clear();
    return true;
  }
  bool end_object() {
    if (depth_ == 3 && section_ == "halves") add_halves();
    --depth_;
    return true;
  }
  bool start_array(std::size_t) { return ++depth_ > 0; }
  bool end_array() { return --depth_ > 0; }
  bool key(std::string& name) {
    if (depth_ == 1) section_ = name;
    if (depth_ <= 2) name_ = std::move(name);
    if (depth_ == 3) part_ = std::move(name);
    return true;
  }
  bool string(std::string& text) {
    if (depth_ == 1 && section_ == "counts") record_.counts = counts_of(text);
    if (is_field()) keep(std::move(text));
    if (depth_ == 3 && part_ == "cells") cells_ = std::move(text);
    if (depth_ == 3 && part_ == "varying") varying_ = std::move(text);
    return true;
  }
  bool number_integer(std::int64_t value) { return number(value); }
  bool number_unsigned(std::uint64_t value) { return number(value); }
  bool number_float(double value, const std::string&) { return number(value); }
  bool boolean(bool) { return true; }
  bool null() { return true; }
  bool binary(std::vector<std::uint8_t>&) { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) {
    return false;
  }

 private:
  template <class Number>
  bool number(Number value) {
    if (is_field()) keep(ordered_json(value).dump());
    if constexpr (std::is_integral_v<Number>) {
      if (depth_ == 3 && part_ == "columns" && value <= kMostCells)
        columns_ = static_cast<long long>(value);
    }
    return true;
  }

  bool is_field() const { return depth_ == 1 || (depth_ == 2 && section_ == "fields"); }

  void keep(std::string text) {
    const auto column = column_of(name_);
    if (!column) return;
    record_.fields[*column] = std::move(text);
    has_fields_ = true;
  }

  // One that cannot be understood: none of them is known.
  void add_halves() {
    MetricHalves halves{name_, {}};
    if (!read_halves(columns_, cells_, varying_, halves.difference)) is_damaged_ = true;
    record_.halves.push_back(std::move(halves));
    if (is_damaged_) record_.halves.clear();
  }

  ResultRecord& record_;
  int depth_ = 0;
  bool has_fields_ = false, is_damaged_ = false;
  std::string section_, name_, part_;  // keys at the first three depths
  long long columns_ = 0;
  std::string cells_, varying_;
};

}  // namespace

std::string cell_line(std::uint64_t number, const ResultRecord& record) {
  ordered_json json;
  if (const std::string& sampler = record.text("sampler"); !sampler.empty())
    json["method"] = sampler + " + " + record.text("filter");
  json["version"] = SPOOL_VERSION;
  json["fields"] = ordered_json::object();
  for (std::size_t i = 0; i < record.fields.size(); ++i) {
    const ResultColumn& column = result_columns()[i];
    if (column.kind != ColumnKind::kCell && !record.fields[i].empty()) {
      json["fields"][column.name] = record.fields[i];
    }
  }
  if (!record.counts.empty()) json["counts"] = counts_text(record.counts);
  for (const MetricHalves& halves : record.halves)
    json["halves"][halves.metric] = halves_json(halves.difference);
  const std::string rest =
      fmt::format(R"({}{}","failed":{},)", kCell, cell_id(number), record.failed() ? 1 : 0) +
      json.dump(-1, ' ', false, ordered_json::error_handler_t::replace).substr(1);
  return fmt::format(R"({}{:08x}",)", kChecksum, checksum_of(rest)) + rest;
}

std::optional<CheckedLine> checked_line(std::string_view line) {
  std::uint32_t checksum = 0;
  if (!skip(line, kChecksum) || !read_hexadecimal(line, 8, checksum) || !skip(line, "\",") ||
      checksum_of(line) != checksum)
    return std::nullopt;
  CheckedLine found;
  if (!skip(line, kCell) || !read_hexadecimal(line, 16, found.number) ||
      !skip(line, "\",\"failed\":") || line.empty())
    return std::nullopt;
  found.failed = line.front() != '0';
  return found;
}

bool read_cell_text(std::string_view text, ResultRecord& record) {
  record.fields.resize(result_columns().size());
  CellReader reader(record);
  return format::read_json(text, reader) && reader.has_fields();
}

}  // namespace spool::tools
