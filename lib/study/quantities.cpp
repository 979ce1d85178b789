#include "lib/study/quantities.h"

#include <algorithm>

#include "lib/core/check.h"
#include "lib/experiment/result_record.h"
#include "lib/metrics/error_metrics.h"

namespace spool {
namespace {

std::vector<Quantity> make_quantities() {
  std::vector<Quantity> list;
  for (const MetricDescription& metric : metrics()) {
    // A sampler that loses no light has an energy of 1 in the mean of images; the mean of their
    // logarithms lies below that of an image with few bright samples.
    const Range range = metric.better == Better::kLower ? Range::kPositive : Range::kReal;
    list.push_back({metric.name, range, true, true});
  }
  for (const char* name :
       {"seconds_total", kCpuTotal, "seconds_sampling", "seconds_filtering", "cpu_sampling",
        "cpu_filtering", "seconds_exchange", "seconds_reading", "seconds_judging",
        "seconds_writing", "peak_memory_mb", kSamplesPerPixel, "efficiency"})
    list.push_back({name});
  for (const std::string& name : density_quantities())
    list.push_back({name, Range::kPositive, false, true});
  for (const char* name : {"saturated_share", "mse_worst_share", "relmse_worst_share"})
    list.push_back({name, Range::kShare});
  for (const char* name :
       {"mse_half_pixels", "relmse_half_pixels", "mse_reference_noise", "relmse_reference_noise"})
    list.push_back({name});
  return list;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> list = make_quantities();
  return list;
}

std::size_t quantity_index(const std::string& name) {
  const auto found = std::ranges::find(quantities(), name, &Quantity::name);
  SPOOL_CHECK(found != quantities().end());
  return static_cast<std::size_t>(found - quantities().begin());
}

}  // namespace spool
