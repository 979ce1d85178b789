#include "tools/verbs/pixel_answer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "lib/core/student.h"

namespace spool::tools {
namespace {

// Student's interval of the samples as they are; of one, or of equal ones, there is none.
void add_running_mean(PixelAnswer& pixel, const std::vector<double>& values) {
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double n = static_cast<double>(i + 1), delta = values[i] - mean;
    mean += delta / n;
    squares += delta * (values[i] - mean);
    const double half = squares == 0.0
                            ? NAN
                            : student_quantile(0.975, n - 1.0) * std::sqrt(squares / (n - 1.0) / n);
    pixel.mean.push_back(mean);
    pixel.low.push_back(mean - half);
    pixel.high.push_back(mean + half);
  }
}

LogHistogram histogram(const std::vector<double>& values) {
  constexpr int kBins = 24;
  std::vector<double> positive;
  std::ranges::copy_if(values, std::back_inserter(positive),
                       [](double v) { return v > 0.0 && std::isfinite(v); });
  LogHistogram result{values.size() - positive.size(), {}, {}};
  if (positive.empty()) return result;
  const auto [low, high] = std::ranges::minmax(positive);
  const double first = std::log10(low);
  const double step = std::max((std::log10(high) - first) / kBins, 1e-3);  // of equal values, too
  result.counts.resize(kBins);
  for (const double v : positive)
    ++result.counts[static_cast<std::size_t>(
        std::clamp(static_cast<int>((std::log10(v) - first) / step), 0, kBins - 1))];
  for (int b = 0; b <= kBins; ++b)
    result.edges.push_back(std::pow(10.0, first + b * step));
  return result;
}

}  // namespace

PixelAnswer pixel_answer(const SamplePool& pool, int x, int y, int most) {
  PixelAnswer pixel;
  pixel.x = x;
  pixel.y = y;
  pixel.capacity = pool.capacity(x, y);
  const int count = most > 0 ? std::min(most, pixel.capacity) : pixel.capacity;
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const Rgb value = pool.sample(x, y, i);
    pixel.recorded.push_back(pool.recorded_index(x, y, i));
    pixel.samples.push_back({value[0], value[1], value[2]});
    values.push_back(luminance(value[0], value[1], value[2]));
  }
  add_running_mean(pixel, values);
  pixel.histogram = histogram(values);
  return pixel;
}

}  // namespace spool::tools
