#include "lib/statistics/feature_statistics.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr int kSquare = 64;  // pixels: the tiles of most recordings

// The recorded indices of the samples taken of piece (x, y).
void find_taken(const SamplePool& pool, const CountImage& n, int x, int y,
                std::vector<std::size_t>& taken) {
  taken.resize(static_cast<std::size_t>(n(x, y)));
  const bool as_recorded = pool.as_recorded();
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const int at = static_cast<int>(i);
    taken[i] = static_cast<std::size_t>(as_recorded ? at : pool.recorded_index(x, y, at));
  }
}

// Recorded samples up to the last that was taken of a pixel in the square.
int samples_needed(const SamplePool& pool, const CountImage& n, const Rectangle& square) {
  const int q = pool.pieces_per_side();
  std::vector<std::size_t> taken;
  std::size_t needed = 0;
  for (int y = square.y0 * q; y < square.y1 * q; ++y) {
    for (int x = square.x0 * q; x < square.x1 * q; ++x) {
      find_taken(pool, n, x, y, taken);
      for (const std::size_t s : taken)
        needed = std::max(needed, s + 1);
    }
  }
  return static_cast<int>(needed);
}

// Welford over the samples taken of every piece in a square of pixels.
Result<void> accumulate_square(const SamplePool& pool, const CountImage& n, const Rectangle& square,
                               double largest, FeatureStatistics& feature, GuardCounts& guards) {
  const RecordedSamples& recording = pool.recording();
  const int q = pool.pieces_per_side();
  const int needed = samples_needed(pool, n, square);
  if (needed == 0) return {};
  SPOOL_ASSIGN(const std::vector<float> values,
               recording.read_feature(feature.layer, square, needed));
  const std::size_t plane =
      static_cast<std::size_t>(square.area()) * static_cast<std::size_t>(needed);
  if (values.size() != plane * feature.mean.size()) {
    return fail(ErrorCode::kData,
                "{}: layer {} has another size than the radiance: record it again",
                recording.name(), feature.layer.name);
  }
  std::vector<std::size_t> taken;
  for (int y = square.y0 * q; y < square.y1 * q; ++y) {
    for (int x = square.x0 * q; x < square.x1 * q; ++x) {
      const std::size_t pixel =
          (static_cast<std::size_t>(y / q - square.y0) * square.width() + (x / q - square.x0)) *
          static_cast<std::size_t>(needed);
      find_taken(pool, n, x, y, taken);
      for (std::size_t c = 0; c < feature.mean.size(); ++c) {
        double mean = 0.0, m2 = 0.0;
        for (std::size_t i = 0; i < taken.size(); ++i) {
          double value = static_cast<double>(values[c * plane + pixel + taken[i]]);
          if (!std::islessequal(std::abs(value), kLargestFeatureValue)) {
            value = 0.0;
            guards.add(Guard::kFeatureNotFinite);
          }
          value = std::clamp(value, -largest, largest);
          const double delta = value - mean;
          mean += delta / static_cast<double>(i + 1);
          m2 += delta * (value - mean);
        }
        feature.mean[c](x, y) = mean;
        feature.variance[c](x, y) = m2;  // for now
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

Result<FeatureStatistics> feature_statistics(const SamplePool& pool, const CountImage& n,
                                             const FeatureLayer& layer, GuardCounts& guards,
                                             double largest) {
  const RecordedSamples& recording = pool.recording();
  const int q = pool.pieces_per_side();
  const int across = (recording.width() + kSquare - 1) / kSquare;
  const int down = (recording.height() + kSquare - 1) / kSquare;
  const auto squares = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  const auto zeros = [&] {
    return std::vector<Plane>(layer.components.size(), Plane(n.width(), n.height()));
  };
  FeatureStatistics feature{layer, zeros(), zeros()};
  std::vector<std::optional<Error>> errors(squares);
  std::vector<GuardCounts> caught(squares);
  parallel_for(squares, [&](std::size_t i) {
    const int x0 = static_cast<int>(i) % across * kSquare;
    const int y0 = static_cast<int>(i) / across * kSquare;
    const Rectangle square = intersect({x0, y0, x0 + kSquare, y0 + kSquare},
                                       {0, 0, recording.width(), recording.height()});
    const Result<void> read = accumulate_square(pool, n, square, largest, feature, caught[i]);
    if (!read) errors[i] = read.error();
  });
  for (std::size_t i = 0; i < squares; ++i) {
    if (errors[i]) return tl::unexpected<Error>(*errors[i]);
    guards += caught[i];
  }
  for (std::size_t c = 0; c < feature.mean.size(); ++c) {
    GuardCounts counted_with_radiance;  // empty pieces; and floors far below any that matter here
    feature.variance[c] =
        variance_of_mean(n, feature.mean[c], feature.variance[c], {}, counted_with_radiance);
    feature.mean[c] = fill_empty_pieces(std::move(feature.mean[c]), n, q, counted_with_radiance);
    feature.variance[c] =
        fill_empty_pieces(std::move(feature.variance[c]), n, q, counted_with_radiance);
  }
  if (layer.name == "depth") normalise_depth(feature);
  return feature;
}

Result<std::vector<FeatureStatistics>> feature_statistics(const SamplePool& pool,
                                                          const CountImage& n,
                                                          GuardCounts& guards) {
  std::vector<FeatureStatistics> features;
  for (const FeatureLayer& layer : pool.recording().features()) {
    SPOOL_ASSIGN(FeatureStatistics feature, feature_statistics(pool, n, layer, guards));
    features.push_back(std::move(feature));
  }
  return features;
}

}  // namespace spool
