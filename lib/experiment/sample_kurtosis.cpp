#include "lib/experiment/sample_kurtosis.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr long long kMostPixels = 4096;
constexpr double kRelativeFloor = 0.01;  // of the squared mean of the picture, as in relMSE

struct PixelCumulants {
  double mean = 0.0;
  double fourth = 0.0, squared_variance = 0.0;
  bool known = false;
};

PixelCumulants cumulants(const RecordedSamples& recording, int x, int y) {
  std::vector<double> values;
  for (int s = 0; s < recording.spp(); ++s) {
    if (recording.rejected(x, y, s)) continue;
    const Rgb sample = recording.radiance(x, y, s);
    values.push_back((static_cast<double>(sample[0]) + sample[1] + sample[2]) / 3.0);
  }
  PixelCumulants found;
  const auto n = static_cast<double>(values.size());
  if (n < 4) return found;
  for (const double value : values)
    found.mean += value / n;
  double m2 = 0.0, m4 = 0.0;
  for (const double value : values) {
    const double square = (value - found.mean) * (value - found.mean);
    m2 += square / n;
    m4 += square * square / n;
  }
  const double k2 = n / (n - 1.0) * m2;
  found.fourth =
      n * n * ((n + 1.0) * m4 - 3.0 * (n - 1.0) * m2 * m2) / ((n - 1.0) * (n - 2.0) * (n - 3.0));
  // The square of k2 is too large by its own variance, fourth / n + 2 sigma^4 / (n - 1).
  found.squared_variance = (k2 * k2 - found.fourth / n) * (n - 1.0) / (n + 1.0);
  found.known = true;
  return found;
}

}  // namespace

double sample_kurtosis(const RecordedSamples& recording) {
  const long long pixels = static_cast<long long>(recording.width()) * recording.height();
  const long long looked_at = std::min(pixels, kMostPixels);
  std::vector<PixelCumulants> found(static_cast<std::size_t>(looked_at));
  parallel_for(found.size(), [&](std::size_t i) {
    const long long pixel = static_cast<long long>(i) * pixels / looked_at;
    found[i] = cumulants(recording, static_cast<int>(pixel % recording.width()),
                         static_cast<int>(pixel / recording.width()));
  });
  double mean = 0.0;
  for (const PixelCumulants& pixel : found)
    mean += pixel.mean / static_cast<double>(looked_at);
  double fourth = 0.0, squared_variance = 0.0;
  for (const PixelCumulants& pixel : found) {
    if (!pixel.known) continue;
    const double scale = pixel.mean * pixel.mean + kRelativeFloor * mean * mean;
    if (!(scale > 0.0)) continue;
    fourth += pixel.fourth / (scale * scale);
    squared_variance += pixel.squared_variance / (scale * scale);
  }
  return squared_variance > 0.0 ? fourth / squared_variance
                                : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace spool
