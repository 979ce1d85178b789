#include "lib/filters/twin_guides/sample_moments.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/pair_features.h"
#include "lib/kernels/sample_clamp.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"
#include "lib/statistics/grown_variance.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

// In units; squares and products of a few of them stay finite in float.
constexpr double kLargestValue = 1e12;

// Up to so many samples variances count twice where tails are heavy.
constexpr std::int32_t kFewSamples = 8;

using Triple = std::array<double, 3>;

struct Moments {
  RgbImage mean, m2;
};

double in_units(double value, const RadianceScale& scale) {
  return std::clamp(value * scale.unit, -kLargestValue, kLargestValue);
}

double luminance_of(const Rgb& x) {
  return luminance(x[0], x[1], x[2]);
}

// What a sample counts in the difference of n samples' halves; parity 0: even positions.
double half_factor(int n, int parity) {
  const double even = (n + 1) / 2, odd = n / 2;
  if (n < 2) return 0.0;
  return parity == 0 ? std::sqrt(odd / even) / n : -std::sqrt(even / odd) / n;
}

// Welford's recurrence over value(sample) of every piece; use(piece, position, sample, values) gets
// them, too.
template <class Value, class Use>
Moments moments_of(const SamplePool& pool, const CountImage& n, Value value, Use use) {
  Moments moments{make_rgb(n.width(), n.height()), make_rgb(n.width(), n.height())};
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t piece = n.index(x, y);
      Triple mean{}, m2{};
      for (int i = 0; i < n[piece]; ++i) {
        const Rgb sample = pool.sample(x, y, i);
        const Triple values = value(piece, sample);
        for (std::size_t c = 0; c < 3; ++c) {
          const double delta = values[c] - mean[c];
          mean[c] += delta / (i + 1);
          m2[c] += delta * (values[c] - mean[c]);
        }
        use(piece, i, sample, values);
      }
      for (std::size_t c = 0; c < 3; ++c) {
        moments.mean[c][piece] = mean[c];
        moments.m2[c][piece] = m2[c];
      }
    }
  });
  return moments;
}

class Filling {
 public:
  Filling(const CountImage& n, int pieces_per_side, const NoisePool& noise_pool)
      : n_(n), pieces_per_side_(pieces_per_side), noise_pool_(noise_pool) {}
  Image<float> filled(Plane plane) const { return to_float(all_filled(std::move(plane))); }
  // Mean and blurred variance; the moments are used up.
  void finish(Moments moments, double key, FloatRgb& mean, FloatRgb& variance,
              GuardCounts& guards) const {
    for (std::size_t c = 0; c < 3; ++c) {
      GuardCounts of_channel;
      Plane v = variance_of_mean(n_, moments.mean[c], moments.m2[c], {VarianceMode::kAuto, key},
                                 of_channel);
      if (c == 1) guards += of_channel;
      moments.m2[c] = {};
      mean[c] = filled(std::move(moments.mean[c]));
      const Plane whole = all_filled(std::move(v));
      variance[c] = convolve(to_float(whole), four_sigma_taps(1.0));
      if (noise_pool_.unused()) continue;
      const Plane grown = grown_variance(whole, noise_pool_.radius);
      for (std::size_t i = 0; i < grown.size(); ++i) {
        const float more = static_cast<float>(grown[i]) - variance[c][i];
        const auto share = static_cast<float>(noise_pool_.share[i]);
        const float missed = share * kFewSamples / static_cast<float>(std::max(n_[i], kFewSamples));
        variance[c][i] = (1.0f + missed) * (variance[c][i] + share * std::max(more, 0.0f));
      }
    }
  }

 private:
  Plane all_filled(Plane plane) const {
    GuardCounts counted_by_the_caller;
    return fill_empty_pieces(std::move(plane), n_, pieces_per_side_, counted_by_the_caller);
  }

  const CountImage& n_;
  int pieces_per_side_;
  const NoisePool& noise_pool_;
};

}  // namespace

SampleMoments sample_moments(const SamplePool& pool, const CountImage& n, const Plane& limit,
                             const NoisePool& noise_pool, const RadianceScale& scale,
                             GuardCounts& guards) {
  const Filling filling(n, pool.pieces_per_side(), noise_pool);
  SampleMoments result;
  const int q = pool.pieces_per_side(), width = n.width();
  std::vector<std::uint64_t> above(static_cast<std::size_t>(n.height()), 0);
  const auto clamped = [&](std::size_t piece, const Rgb& x) {
    const int at = static_cast<int>(piece);
    const double most = limit(at % width / q, at / width / q);
    const double l = luminance_of(x);
    const double factor = l > most ? most / l : 1.0;
    above[static_cast<std::size_t>(at / width)] += l > most ? 1 : 0;  // a row belongs to one thread
    return Triple{in_units(x[0] * factor, scale), in_units(x[1] * factor, scale),
                  in_units(x[2] * factor, scale)};
  };
  RgbImage difference = make_rgb(n.width(), n.height());
  const int groups = number_of_groups(n);
  result.clamped_light.assign(static_cast<std::size_t>(groups),
                              Image<float>(n.width(), n.height()));
  const auto add_difference = [&](std::size_t piece, int i, const Rgb& x, const Triple& values) {
    const double taken =
        in_units(luminance_of(x), scale) - luminance(values[0], values[1], values[2]);
    if (taken > 0.0) {
      const int group = i % groups, of_group = (n[piece] - group + groups - 1) / groups;
      result.clamped_light[static_cast<std::size_t>(group)][piece] +=
          static_cast<float>(taken / of_group);
    }
    const double factor = half_factor(n[piece], i % 2);
    for (std::size_t c = 0; c < 3; ++c)
      difference[c][piece] += factor * values[c];
  };
  filling.finish(moments_of(pool, n, clamped, add_difference), scale.mean, result.mean,
                 result.variance, guards);
  for (std::size_t c = 0; c < 3; ++c)
    result.difference[c] = filling.filled(std::move(difference[c]));
  for (const std::uint64_t of_row : above)
    guards.add(Guard::kClampedSample, of_row);

  const double floor = kLogFloor * scale.mean;
  const auto log_of =
      [&](double x) -> double {  // in float: the guides are, and it takes half the time
    return std::log(static_cast<float>(std::max(in_units(x, scale), 0.0) + floor));
  };
  const auto logs = [&](std::size_t, const Rgb& x) {
    return Triple{log_of(x[0]), log_of(x[1]), log_of(x[2])};
  };
  Plane log_luminance(n.width(), n.height());
  const auto add_luminance = [&](std::size_t piece, int i, const Rgb& x, const Triple&) {
    log_luminance[piece] += (log_of(luminance_of(x)) - log_luminance[piece]) / (i + 1);
  };
  GuardCounts of_logarithms;  // a floor that no radiance meets
  filling.finish(moments_of(pool, n, logs, add_luminance), 1.0, result.log_mean,
                 result.log_variance, of_logarithms);
  result.log_luminance = filling.filled(std::move(log_luminance));
  return result;
}

}  // namespace spool
