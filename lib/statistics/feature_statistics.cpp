#include "lib/statistics/feature_statistics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lib/core/parallel.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr int kBandRows = 64;  // pixels: the tiles of most recordings

// Welford over the samples taken of every piece in a band of pixel rows.
Result<void> accumulate_band(const SamplePool& pool, const CountImage& n, int first_row,
                             FeatureStatistics& feature, GuardCounts& guards) {
  const RecordedSamples& recording = pool.recording();
  const int width = recording.width(), spp = recording.spp(), q = pool.pieces_per_side();
  const Rectangle band{0, first_row, width, std::min(first_row + kBandRows, recording.height())};
  SPOOL_ASSIGN(const std::vector<float> values, recording.read_feature(feature.layer, band));
  const std::size_t plane = static_cast<std::size_t>(band.area()) * static_cast<std::size_t>(spp);
  if (values.size() != plane * feature.mean.size()) {
    return fail(ErrorCode::kData,
                "{}: layer {} has another size than the radiance: record it again",
                recording.name(), feature.layer.name);
  }
  for (int y = band.y0 * q; y < band.y1 * q; ++y) {
    for (int x = 0; x < width * q; ++x) {
      const std::size_t pixel = (static_cast<std::size_t>(y / q - band.y0) * width + x / q) * spp;
      for (int i = 0; i < n(x, y); ++i) {
        const std::size_t s = pixel + static_cast<std::size_t>(pool.recorded_index(x, y, i));
        for (std::size_t c = 0; c < feature.mean.size(); ++c) {
          double value = static_cast<double>(values[c * plane + s]);
          if (!std::islessequal(std::abs(value), static_cast<double>(kLargestRadiance))) {
            value = 0.0;
            guards.add(Guard::kFeatureNotFinite);
          }
          double& mean = feature.mean[c](x, y);
          const double delta = value - mean;
          mean += delta / (i + 1);
          feature.variance[c](x, y) += delta * (value - mean);  // M2 for now
        }
      }
    }
  }
  return {};
}

void normalise_depth(FeatureStatistics& depth) {
  double largest = 0.0;
  for (const double v : depth.mean[0].pixels())
    largest = std::max(largest, std::abs(v));
  if (!(largest > 0.0)) return;
  for (double& v : depth.mean[0].pixels())
    v /= largest;
  for (double& v : depth.variance[0].pixels())
    v /= largest * largest;
}

}  // namespace

Result<std::vector<FeatureStatistics>> feature_statistics(const SamplePool& pool,
                                                          const CountImage& n,
                                                          GuardCounts& guards) {
  const RecordedSamples& recording = pool.recording();
  const int q = pool.pieces_per_side();
  const auto bands = static_cast<std::size_t>((recording.height() + kBandRows - 1) / kBandRows);
  std::vector<FeatureStatistics> features;
  for (const FeatureLayer& layer : recording.features()) {
    const std::vector<Plane> empty(layer.components.size(), Plane(n.width(), n.height()));
    FeatureStatistics feature{layer, empty, empty};
    std::vector<std::optional<Error>> errors(bands);
    std::vector<GuardCounts> caught(bands);
    parallel_for(bands, [&](std::size_t b) {
      const Result<void> read =
          accumulate_band(pool, n, static_cast<int>(b) * kBandRows, feature, caught[b]);
      if (!read) errors[b] = read.error();
    });
    for (std::size_t b = 0; b < bands; ++b) {
      if (errors[b]) return tl::unexpected<Error>(*errors[b]);
      guards += caught[b];
    }
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      GuardCounts counted_with_radiance;  // empty pieces; and floors far below any that matter here
      feature.variance[c] =
          variance_of_mean(n, feature.mean[c], feature.variance[c], {}, counted_with_radiance);
      feature.mean[c] = fill_empty_pieces(feature.mean[c], n, q, counted_with_radiance);
      feature.variance[c] = fill_empty_pieces(feature.variance[c], n, q, counted_with_radiance);
    }
    if (layer.name == "depth") normalise_depth(feature);
    features.push_back(std::move(feature));
  }
  return features;
}

}  // namespace spool
