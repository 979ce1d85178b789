#include "tools/verbs/pixel_answer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lib/inference/student.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

struct Running {
  std::vector<double> mean, low, high;  // of the luminance of the first 1, 2, ... samples
};

// The interval is Student's of the samples as they are; of one sample there is none.
Running running_mean(const std::vector<double>& values) {
  Running running;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double n = static_cast<double>(i + 1), delta = values[i] - mean;
    mean += delta / n;
    squares += delta * (values[i] - mean);
    const double half =
        i == 0 ? NAN : student_quantile(0.975, n - 1.0) * std::sqrt(squares / (n - 1.0) / n);
    running.mean.push_back(mean);
    running.low.push_back(mean - half);
    running.high.push_back(mean + half);
  }
  return running;
}

// Of the positive values on a logarithmic axis; the others are counted apart.
ordered_json histogram(const std::vector<double>& values) {
  constexpr int kBins = 24;
  std::vector<double> positive;
  std::ranges::copy_if(values, std::back_inserter(positive),
                       [](double v) { return v > 0.0 && std::isfinite(v); });
  ordered_json result = {{"not_positive", values.size() - positive.size()},
                         {"edges", ordered_json::array()},
                         {"counts", ordered_json::array()}};
  if (positive.empty()) return result;
  const auto [low, high] = std::ranges::minmax(positive);
  const double first = std::log10(low);
  const double step = std::max((std::log10(high) - first) / kBins, 1e-3);  // of equal values, too
  std::vector<int> counts(kBins);
  for (const double v : positive)
    ++counts[static_cast<std::size_t>(
        std::clamp(static_cast<int>((std::log10(v) - first) / step), 0, kBins - 1))];
  for (int b = 0; b <= kBins; ++b)
    result["edges"].push_back(std::pow(10.0, first + b * step));
  result["counts"] = counts;
  return result;
}

}  // namespace

ordered_json pixel_answer(const SamplePool& pool, int x, int y, int most) {
  const int capacity = pool.capacity(x, y);
  const int count = most > 0 ? std::min(most, capacity) : capacity;
  ordered_json pixel = {{"x", x}, {"y", y}, {"capacity", capacity}};
  std::vector<int> recorded;
  std::vector<std::array<float, 3>> samples;
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const Rgb value = pool.sample(x, y, i);
    recorded.push_back(pool.recorded_index(x, y, i));
    samples.push_back({value[0], value[1], value[2]});
    values.push_back(luminance(value[0], value[1], value[2]));
  }
  Running running = running_mean(values);
  pixel["recorded"] = recorded;
  pixel["samples"] = samples;
  pixel["mean"] = running.mean;
  pixel["low"] = running.low;
  pixel["high"] = running.high;
  pixel["histogram"] = histogram(values);
  return pixel;
}

ordered_json footprint_answer(const Footprint& footprint) {
  ordered_json taps = ordered_json::array(), shapes = ordered_json::array();
  for (const auto& [place, tap] : footprint.taps) {
    if (tap.weight == 0.0) continue;
    ordered_json entry = {place.second, place.first, tap.weight};
    for (const double weighted : tap.weighted)
      entry.push_back(weighted / tap.weight);
    taps.push_back(std::move(entry));
  }
  for (const FootprintShape& shape : footprint.shapes)
    shapes.push_back(
        {{"size", shape.size}, {"direction", shape.direction}, {"widths", shape.widths}});
  return {{"taps", taps}, {"shapes", shapes}};
}

}  // namespace spool::tools
