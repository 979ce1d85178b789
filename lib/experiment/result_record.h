// What is kept of a finished cell: the fields of its row, and how some metrics vary over the
// resamples of the block bootstrap, so that methods can be compared in pairs later, by another
// process too.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/inference/comparison.h"

namespace spool {

// Metrics whose resamples are kept: those that methods are compared by.
const std::vector<std::string>& compared_metrics();

struct ResultRecord {
  std::vector<std::string> fields;  // as result_columns()
  // Value of each resample less the value itself, [compared metric][resample]; empty where the
  // metric is not defined. 32-bit floats: differences of methods lose 6e-8 of the spread.
  std::vector<std::vector<float>> deviations;

  const std::string& text(std::string_view column) const;
  double number(std::string_view column) const;  // NaN where the field is empty
  int blocks() const;                            // of the bootstrap; 0 where there is no image
  // There is no result, or pixels are missing in it.
  bool failed() const { return !text("error").empty(); }
};

ResultRecord record_of(const CellResult& result);

// One of compared_metrics() over the replicates of a method.
MethodSeries record_series(std::string name, std::string_view metric,
                           std::span<const ResultRecord* const> replicates);

}  // namespace spool
