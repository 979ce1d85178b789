#include "lib/kernels/feature_guide.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"
#include "lib/statistics/feature_statistics.h"

namespace spool {
namespace {

constexpr float kLeastVariance = FeatureGuide::kLeastVariance;
constexpr double kMostVariance = 1e12;  // so that those of all features times each other are finite

Image<float> to_float(const Plane& plane, double most = std::numeric_limits<float>::max()) {
  Image<float> image(plane.width(), plane.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    image[i] = static_cast<float>(std::min(plane[i], most));
  return image;
}

// One feature of two rows of pieces.
struct FeatureRows {
  std::array<const float*, 3> p, q;  // [channel]
  int channels;
  const float *vp, *vq;
  float factor;
};

constexpr int kLanes = 16;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));

// to[x] = exp(-sum of the features' terms), which are brought to one denominator: a division costs
// as much as the rest. kLanes pieces at once, the last of them twice where `count` is no multiple.
SPOOL_VECTOR_CLONES
void weights_of_rows(const FeatureRows* features, std::size_t feature_count, int count,
                     float* __restrict to) {
  for (int begin = 0; begin < count; begin += kLanes) {
    const int x = std::min(begin, count - kLanes);
    // Not by value: a clone and a function that is not cloned disagree on where wide vectors are.
    const auto load = [x](const float* row, Floats& values) {
      std::memcpy(&values, row + x, sizeof(values));
    };
    Floats a, b;
    Floats distances{}, divisor = Floats{} + 1.0f;
    for (std::size_t f = 0; f < feature_count; ++f) {
      const FeatureRows& feature = features[f];
      Floats squares{};
      for (int c = 0; c < feature.channels; ++c) {
        load(feature.p[c], a);
        load(feature.q[c], b);
        const Floats difference = a - b;
        squares += difference * difference;
      }
      load(feature.vp, a);
      load(feature.vq, b);
      const Floats sum = a + b;
      const Floats variance = sum > kLeastVariance ? sum : Floats{} + kLeastVariance;
      distances = distances * variance + feature.factor * squares * divisor;
      divisor *= variance;
    }
    distances /= divisor;
    float weights[kLanes];
    std::memcpy(weights, &distances, sizeof(weights));
    for (int l = 0; l < kLanes; ++l)
      weights[l] = exp_negative(weights[l]);
    std::memcpy(to + x, weights, sizeof(weights));
  }
}

float weight_of_piece(const FeatureRows* features, std::size_t feature_count, int x) {
  float distances = 0.0f, divisor = 1.0f;
  for (std::size_t f = 0; f < feature_count; ++f) {
    const FeatureRows& feature = features[f];
    float squares = 0.0f;
    for (int c = 0; c < feature.channels; ++c) {
      const float difference = feature.p[c][x] - feature.q[c][x];
      squares += difference * difference;
    }
    const float variance = std::max(kLeastVariance, feature.vp[x] + feature.vq[x]);
    distances = distances * variance + feature.factor * squares * divisor;
    divisor *= variance;
  }
  return exp_negative(distances / divisor);
}

}  // namespace

Result<FeatureGuide> make_feature_guide(const SamplePool& pool, const CountImage& n,
                                        const std::function<double(std::string_view)>& tolerance,
                                        GuardCounts& guards) {
  FeatureGuide guide{n.width(), n.height(), {}};
  SPOOL_CHECK_LE(pool.recording().features().size(), FeatureGuide::kMostFeatures);
  for (const FeatureLayer& layer : pool.recording().features()) {
    SPOOL_CHECK_LE(layer.components.size(), std::size_t{3});
    SPOOL_ASSIGN(const FeatureStatistics feature, feature_statistics(pool, n, layer, guards));
    FeatureGuide::Feature entry;
    Plane variance(guide.width, guide.height);
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      entry.mean.push_back(to_float(feature.mean[c]));
      for (std::size_t i = 0; i < variance.size(); ++i)
        variance[i] +=
            std::max(1, n[i]) * feature.variance[c][i] / static_cast<double>(feature.mean.size());
    }
    entry.variance = to_float(variance, kMostVariance);
    const double sigma = tolerance(layer.name);
    entry.factor = static_cast<float>(1.0 / (2.0 * sigma * sigma));
    guide.features.push_back(std::move(entry));
  }
  return guide;
}

void feature_weights(const FeatureGuide& guide, int y, int qy, int dx, int x0, int x1, float* to) {
  const std::size_t size = guide.features.size();
  std::array<FeatureRows, FeatureGuide::kMostFeatures> rows;
  for (std::size_t f = 0; f < size; ++f) {
    const FeatureGuide::Feature& feature = guide.features[f];
    rows[f].channels = static_cast<int>(feature.mean.size());
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      rows[f].p[c] = &feature.mean[c](x0, y);
      rows[f].q[c] = &feature.mean[c](x0 + dx, qy);
    }
    rows[f].vp = &feature.variance(x0, y);
    rows[f].vq = &feature.variance(x0 + dx, qy);
    rows[f].factor = feature.factor;
  }
  if (x1 - x0 >= kLanes) {
    weights_of_rows(rows.data(), size, x1 - x0, to);
  } else {
    for (int x = 0; x < x1 - x0; ++x)
      to[x] = weight_of_piece(rows.data(), size, x);
  }
}

}  // namespace spool
