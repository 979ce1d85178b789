#include "lib/filters/ensemble.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/scene_luminance.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

constexpr double kReach = 16.0;  // pixels, of the Gaussian over which weights are estimated
constexpr double kFloor = 0.1;   // times the scene's luminance: relative errors below it
constexpr double kLimit = 20.0;  // a sample's mean counts up to so many times its surroundings
constexpr double kLeastLuminance = 1e-20;  // nothing is divided by 0
constexpr double kLeastRidge = 1e-12;      // parts that are all alike have equal weights
constexpr double kWeightsMemory = 260;     // bytes a pixel beside the parts' images

double luminance_of(const RgbImage& image, std::size_t p) {
  return luminance(image[0][p], image[1][p], image[2][p]);
}

RgbImage mean_of(std::span<const RgbImage* const> images) {
  RgbImage mean = *images[0];
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < mean[c].size(); ++p) {
      for (std::size_t k = 1; k < images.size(); ++k)
        mean[c][p] += (*images[k])[c][p];
      mean[c][p] /= static_cast<double>(images.size());
    }
  }
  return mean;
}

// `mean` with pixels far above their surroundings `top` scaled down: a firefly judges nothing.
RgbImage limited(RgbImage mean, const Plane& top) {
  for (std::size_t p = 0; p < top.size(); ++p) {
    const double factor = std::min(1.0, top[p] / std::max(luminance_of(mean, p), kLeastLuminance));
    for (Plane& channel : mean)
      channel[p] *= factor;
  }
  return mean;
}

// w' M w - 2 r' w over a pixel's weights.
struct Quadratic {
  std::array<std::array<double, kMostEnsembleParts>, kMostEnsembleParts> m{};
  std::array<double, kMostEnsembleParts> r{};
};
using Weights = std::array<double, kMostEnsembleParts>;

// The least of the quadratic where the weights of `members` sum to 1 and the others are 0; none
// where the system is singular. Elimination with the largest pivot.
std::optional<Weights> least_on_face(const Quadratic& q, std::span<const std::size_t> members) {
  constexpr std::size_t kMost = kMostEnsembleParts + 1;
  const std::size_t n = members.size() + 1;
  std::array<std::array<double, kMost + 1>, kMost> a{};
  for (std::size_t i = 0; i + 1 < n; ++i) {
    for (std::size_t j = 0; j + 1 < n; ++j)
      a[i][j] = q.m[members[i]][members[j]];
    a[i][n - 1] = a[n - 1][i] = 1.0;
    a[i][n] = q.r[members[i]];
  }
  a[n - 1][n] = 1.0;
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    if (a[pivot][column] == 0.0) return std::nullopt;
    std::swap(a[column], a[pivot]);
    for (std::size_t row = 0; row < n; ++row) {
      if (row == column) continue;
      const double factor = a[row][column] / a[column][column];
      for (std::size_t k = column; k <= n; ++k)
        a[row][k] -= factor * a[column][k];
    }
  }
  Weights weights{};
  for (std::size_t i = 0; i + 1 < n; ++i)
    weights[members[i]] = a[i][n] / a[i][i];
  return weights;
}

double value_of(const Quadratic& q, const Weights& w, std::size_t parts) {
  double value = 0.0;
  for (std::size_t j = 0; j < parts; ++j) {
    value -= 2.0 * q.r[j] * w[j];
    for (std::size_t k = 0; k < parts; ++k)
      value += w[j] * q.m[j][k] * w[k];
  }
  return value;
}

// The matrix may be indefinite, so every face of the simplex is tried, the smallest first.
Weights best_weights(const Quadratic& q, std::size_t parts) {
  Weights best{};
  best.fill(1.0 / static_cast<double>(parts));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t size = 1; size <= parts; ++size) {
    for (unsigned face = 1; face < (1u << parts); ++face) {
      std::vector<std::size_t> members;
      for (std::size_t k = 0; k < parts; ++k) {
        if ((face >> k) & 1u) members.push_back(k);
      }
      if (members.size() != size) continue;
      const std::optional<Weights> found = least_on_face(q, members);
      if (!found || !std::ranges::all_of(*found, [](double w) { return w >= 0.0; })) continue;
      const double value = value_of(q, *found, parts);
      if (value < least) least = value, best = *found;
    }
  }
  return best;
}

struct Sums {
  std::vector<std::vector<Plane>> m;  // [j][k >= j]
  std::vector<Plane> r;
};

// Per pixel, unblurred. A half's images are judged by the other half's mean; the last term of each
// brings the noise of a half to that of the mean of two.
Sums sums_of(std::span<const HalfImages> parts, const HalfImages& judges, const HalfImages& mean,
             const RgbImage& relative) {
  const Plane empty(mean[0][0].width(), mean[0][0].height());
  Sums sums;
  sums.r.assign(parts.size(), empty);
  sums.m.assign(parts.size(), std::vector<Plane>(parts.size(), empty));
  parallel_for(empty.size(), [&](std::size_t p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double omega = relative[c][p], ma = mean[0][c][p], mb = mean[1][c][p];
      const double ta = judges[0][c][p], tb = judges[1][c][p];
      const auto a = [&](std::size_t k) { return parts[k][0][c][p] - ma; };
      const auto b = [&](std::size_t k) { return parts[k][1][c][p] - mb; };
      for (std::size_t k = 0; k < parts.size(); ++k) {
        sums.r[k][p] +=
            omega * (a(k) * (tb - ma) + b(k) * (ta - mb) + 0.5 * (a(k) - b(k)) * (ma - mb));
        for (std::size_t j = 0; j <= k; ++j) {
          sums.m[j][k][p] +=
              omega * (a(j) * a(k) + b(j) * b(k) - 0.5 * (a(j) - b(j)) * (a(k) - b(k)));
        }
      }
    }
  });
  return sums;
}

class Ensemble {
 public:
  Ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options)
      : parts_(std::move(parts)), options_(options) {}

  Result<Reconstruction> operator()(const Selection& selection, const SamplePool& pool,
                                    const FilterContext& context) const {
    const bool four =
        std::ranges::all_of(selection.statistics.n.pixels(), [](int n) { return n >= 4; });
    const bool halves = options_.weights == EnsembleWeights::kHalves;
    const bool split = halves && four;
    const double runs = split ? 3.0 : 1.0;
    Reconstruction result;
    SPOOL_ASSIGN(const std::vector<RgbImage> whole,
                 images(selection, pool, context, 0.0, runs, result));
    std::vector<const RgbImage*> all;
    for (const RgbImage& image : whole)
      all.push_back(&image);
    result.image = mean_of(all);
    if (halves && !four)
      result.notes.emplace_back(
          "ensemble: weights=halves needs 4 samples in every piece: equal weights");
    if (!split) return result;
    std::vector<HalfImages> of_halves(parts_.size());
    HalfImages means;
    for (int h = 0; h < 2; ++h) {
      const auto side = static_cast<std::size_t>(h);
      const SamplePool half_pool = pool.half(h);
      const Selection half{half_statistics(selection.statistics, half_pool, h),
                           selection.attenuation};
      means[side] = pixel_means(prefix_means(pool.without_limits().half(h), half.statistics.n),
                                result.guards);
      SPOOL_ASSIGN(std::vector<RgbImage> found,
                   images(half, half_pool, context, 1.0 + h, runs, result));
      for (std::size_t k = 0; k < parts_.size(); ++k)
        of_halves[k][side] = std::move(found[k]);
    }
    const std::vector<Plane> weights = cross_fitted_weights(
        of_halves, means, scene_luminance(selection.statistics, result.guards));
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < weights[0].size(); ++p) {
        double sum = 0.0;
        for (std::size_t k = 0; k < whole.size(); ++k)
          sum += weights[k][p] * whole[k][c][p];
        result.image[c][p] = sum;
      }
    }
    return result;
  }

 private:
  // One of each part; their notes and guards go to `result`.
  Result<std::vector<RgbImage>> images(const Selection& selection, const SamplePool& pool,
                                       const FilterContext& context, double done, double runs,
                                       Reconstruction& result) const {
    std::vector<RgbImage> found;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      FilterContext of_part = context;
      of_part.views = nullptr;
      of_part.footprints = nullptr;
      of_part.variance = false;
      const auto n = static_cast<double>(parts_.size());
      if (context.progress) {
        of_part.progress = [&, k](double share) {
          context.progress((done + (static_cast<double>(k) + share) / n) / runs);
        };
      }
      SPOOL_ASSIGN(Reconstruction one, parts_[k](selection, pool, of_part));
      if (!found.empty() && !one.image[0].same_size(found[0][0])) {
        return fail(
            ErrorCode::kData, "ensemble: its parts have images of {} x {} and {} x {} pixels",
            found[0][0].width(), found[0][0].height(), one.image[0].width(), one.image[0].height());
      }
      for (std::string& note : one.notes) {
        if (std::ranges::find(result.notes, note) == result.notes.end())
          result.notes.push_back(std::move(note));
      }
      result.guards += one.guards;
      result.exchange_seconds += one.exchange_seconds;
      found.push_back(std::move(one.image));
    }
    return found;
  }

  std::vector<ReadyFilter> parts_;
  EnsembleOptions options_;
};

// One part works at a time.
void add_part(WorkingMemory& memory, const WorkingMemory& part) {
  memory.per_pixel = std::max(memory.per_pixel, part.per_pixel);
  memory.fixed += part.fixed;
}

Needs needs_of(const std::vector<ReadyFilter>& parts, bool halves) {
  Needs needs{.signal = false, .variance = false, .pool = false, .samples = false};
  for (const ReadyFilter& part : parts) {
    needs.features = std::max(needs.features, part.needs.features);
    needs.film_positions = std::max(needs.film_positions, part.needs.film_positions);
    needs.reference = needs.reference || part.needs.reference;
    needs.signal = needs.signal || part.needs.signal;
    needs.variance = needs.variance || part.needs.variance;
    needs.pool = needs.pool || part.needs.pool;
    needs.samples = needs.samples || part.needs.samples;
  }
  needs.signal = needs.signal || halves;
  needs.variance = needs.variance || halves;
  needs.pool = needs.pool || halves;
  return needs;
}

}  // namespace

OptionTable<EnsembleOptions> ensemble_option_table() {
  return {choice_option<EnsembleOptions, EnsembleWeights>(
      "weights", &EnsembleOptions::weights,
      {{"mean", EnsembleWeights::kMean}, {"halves", EnsembleWeights::kHalves}},
      "mean: equal; halves: by the error that two halves of the samples show, at three times the "
      "cost")};
}

ReadyFilter ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options) {
  SPOOL_CHECK_GE(parts.size(), std::size_t{2});
  SPOOL_CHECK_LE(parts.size(), kMostEnsembleParts);
  const bool halves = options.weights == EnsembleWeights::kHalves;
  // Their images stay while the next part works; 24 bytes a pixel each.
  const double kept = 24.0 * static_cast<double>(parts.size()) * (halves ? 3.0 : 1.0) +
                      (halves ? kWeightsMemory : 0.0);
  WorkingMemory memory, of_means;
  for (const ReadyFilter& part : parts) {
    add_part(memory, part.memory);
    add_part(of_means, part.memory_of_means.value_or(part.memory));
  }
  memory.per_pixel += kept;
  of_means.per_pixel += kept;
  Needs needs = needs_of(parts, halves);
  return {Ensemble(std::move(parts), options), std::move(needs), memory, of_means};
}

std::vector<Plane> cross_fitted_weights(std::span<const HalfImages> parts, const HalfImages& means,
                                        double luminance_unit) {
  SPOOL_CHECK_LE(parts.size(), kMostEnsembleParts);
  HalfImages mean;
  for (std::size_t h = 0; h < 2; ++h) {
    std::vector<const RgbImage*> images;
    for (const HalfImages& part : parts)
      images.push_back(&part[h]);
    mean[h] = mean_of(images);
  }
  RgbImage both = mean[0], relative = mean[0];
  const double floor = kFloor * luminance_unit;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < both[c].size(); ++p) {
      both[c][p] = std::max(0.0, 0.5 * (mean[0][c][p] + mean[1][c][p]));
      relative[c][p] = 1.0 / (both[c][p] * both[c][p] + floor * floor);
    }
  }
  Plane top(both[0].width(), both[0].height());
  for (std::size_t p = 0; p < top.size(); ++p)
    top[p] = luminance_of(both, p);
  top = truncated_mean(top, four_sigma_taps(1.0));
  for (double& value : top.pixels())
    value = kLimit * (value + floor);
  const HalfImages judges = {limited(means[0], top), limited(means[1], top)};
  Sums sums = sums_of(parts, judges, mean, relative);
  const Taps taps = four_sigma_taps(kReach);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    sums.r[k] = truncated_mean(sums.r[k], taps);
    for (std::size_t j = 0; j <= k; ++j)
      sums.m[j][k] = truncated_mean(sums.m[j][k], taps);
  }
  std::vector<Plane> weights(parts.size(), Plane(top.width(), top.height()));
  parallel_for(top.size(), [&](std::size_t p) {
    Quadratic q;
    double ridge = 0.0;
    const auto n = static_cast<double>(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      q.r[k] = sums.r[k][p];
      for (std::size_t j = 0; j <= k; ++j)
        q.m[j][k] = q.m[k][j] = sums.m[j][k][p];
      ridge += std::max(0.0, q.m[k][k]) / n;
    }
    ridge += kLeastRidge;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      q.m[k][k] += ridge;
      q.r[k] += ridge / n;
    }
    const Weights found = best_weights(q, parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
      weights[k][p] = found[k];
  });
  return weights;
}

}  // namespace spool
