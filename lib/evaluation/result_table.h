// The columns of every table of results: name, meaning and how to read them from a cell. The CSV,
// docs/results.md and the report all come from this list, so they cannot drift apart.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/evaluation/experiment.h"

namespace spool {

struct ResultColumn {
  std::string name;
  std::string meaning;
  bool is_number = true;
  std::function<std::string(const CellResult&)> text;  // empty: not known or not defined
};

// dump, sampler, filter, spp, replicate; each metric and its standard error (NAME_se); samples and
// time; how it was judged; guards; error.
const std::vector<ResultColumn>& result_columns();

std::string csv_header();
// Fields quoted as RFC 4180 wants where they hold a comma, a quote or a line break.
std::string to_csv_row(const CellResult& result);

// 1 / (MSE * seconds), or nothing where MSE <= 2 standard errors: unresolved.
std::optional<double> efficiency(const CellResult& result);

}  // namespace spool
