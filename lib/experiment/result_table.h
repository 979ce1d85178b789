// The columns of every table of results: name, meaning and how to read them from a cell. The CSV,
// docs/results.md and the report all come from this list, so they cannot drift apart.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/experiment/experiment.h"

namespace spool {

// kCell says which cell it is; kTiming (times, threads, memory) differs from run to run; all other
// columns are the same bits for the same cell, whenever and on however many threads it ran.
enum class ColumnKind { kCell, kResult, kTiming };

struct ResultColumn {
  std::string name;
  std::string meaning;
  bool is_number = true;
  ColumnKind kind = ColumnKind::kResult;
  std::function<std::string(const CellResult&)> text;  // empty: not known or not defined
};

// dump, sampler, filter, spp, replicate; each metric and its standard error (NAME_se); samples and
// time; how it was judged; guards; error.
const std::vector<ResultColumn>& result_columns();

std::size_t column_index(std::string_view name);  // the column must exist

// The fields of a row, as result_columns().
std::vector<std::string> result_fields(const CellResult& result);

std::string csv_header();
// Fields quoted as RFC 4180 requires where they hold a comma, a quote or a line break; ' before a
// text that a spreadsheet would compute.
std::string to_csv_row(const std::vector<std::string>& fields);
std::string to_csv_row(const CellResult& result);
// One JSON object in one line: numbers as numbers, an empty field as null, an infinite one as text.
std::string to_json_line(const std::vector<std::string>& fields);

// 1 / (MSE * seconds), or nothing where MSE <= 2 standard errors: unresolved.
std::optional<double> efficiency(const CellResult& result);

}  // namespace spool
