// The quantities of a result that a study averages: the metrics, times, shares.
#pragma once

#include <string>
#include <vector>

#include "lib/inference/intervals.h"

namespace spool {

// A column of results, or one made of several.
struct Quantity {
  std::string name;
  Range range = Range::kPositive;
  bool is_metric = false;
  bool is_compared = false;  // between methods: a metric, or of where samples are
};
const std::vector<Quantity>& quantities();
std::size_t quantity_index(const std::string& name);  // of one that is there

// Processor seconds of sampling and filtering, and of rendering where the recording has them.
inline constexpr const char* kCpuTotal = "cpu_total";
inline constexpr const char* kSamplesPerPixel = "samples_per_pixel";

}  // namespace spool
