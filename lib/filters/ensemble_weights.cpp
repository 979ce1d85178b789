#include "lib/filters/ensemble_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "lib/core/error.h"
#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"

namespace spool {
namespace {

constexpr double kReach = 16.0;  // pixels, of the Gaussian over which weights are estimated
constexpr double kFloor = 0.1;   // times the scene's luminance: relative errors below it
constexpr double kLimit = 20.0;  // a sample's mean counts up to so many times its surroundings
constexpr double kPrior = 0.25;  // of equal weights, in mean diagonals of M
constexpr double kLeastLuminance = 1e-20;  // nothing is divided by 0
constexpr double kLeastRidge = 1e-12;      // parts that are all alike have equal weights

double luminance_of(const RgbImage& image, std::size_t p) {
  return luminance(image[0][p], image[1][p], image[2][p]);
}

}  // namespace

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

namespace {

// What the means of samples are held against.
struct Surroundings {
  const RgbImage& picture;  // of the parts
  double floor;
  Plane top;    // luminance that a pixel's mean may have
  Plane level;  // luminance of the picture, over the reach of the weights
};

Surroundings surroundings_of(const RgbImage& picture, double floor) {
  Plane bright(picture[0].width(), picture[0].height());
  for (std::size_t p = 0; p < bright.size(); ++p)
    bright[p] = luminance_of(picture, p);
  Plane top = truncated_mean(bright, four_sigma_taps(1.0));
  for (double& value : top.pixels())
    value = kLimit * (value + floor);
  return {picture, floor, std::move(top), truncated_mean(bright, four_sigma_taps(kReach))};
}

// `mean` with pixels far above their surroundings scaled down: a firefly judges nothing. What that
// takes comes back around them in the shape of the parts' picture, as far as the picture has that
// light: judges that have lost light favour parts that have lost it, too.
RgbImage judge_of(RgbImage mean, const Surroundings& around) {
  Plane taken(mean[0].width(), mean[0].height()), kept = taken;
  for (std::size_t p = 0; p < taken.size(); ++p) {
    const double l = luminance_of(mean, p);
    const double factor = std::min(1.0, around.top[p] / std::max(l, kLeastLuminance));
    kept[p] = factor * l;
    taken[p] = l - kept[p];
    for (Plane& channel : mean)
      channel[p] *= factor;
  }
  const Taps taps = four_sigma_taps(kReach);
  taken = truncated_mean(taken, taps);
  kept = truncated_mean(kept, taps);
  for (std::size_t p = 0; p < taken.size(); ++p) {
    const double missing = around.level[p] - kept[p];
    const double back =
        std::min(taken[p], std::max(0.0, missing)) / (around.level[p] + around.floor);
    for (std::size_t c = 0; c < 3; ++c)
      mean[c][p] += (around.picture[c][p] + around.floor) * back;
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

}  // namespace

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
  const Surroundings around = surroundings_of(both, floor);
  const HalfImages judges = {judge_of(means[0], around), judge_of(means[1], around)};
  Sums sums = sums_of(parts, judges, mean, relative);
  const Taps taps = four_sigma_taps(kReach);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    sums.r[k] = truncated_mean(sums.r[k], taps);
    for (std::size_t j = 0; j <= k; ++j)
      sums.m[j][k] = truncated_mean(sums.m[j][k], taps);
  }
  std::vector<Plane> weights(parts.size(), Plane(both[0].width(), both[0].height()));
  parallel_for(weights[0].size(), [&](std::size_t p) {
    Quadratic q;
    double ridge = 0.0;
    const auto n = static_cast<double>(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      q.r[k] = sums.r[k][p];
      for (std::size_t j = 0; j <= k; ++j)
        q.m[j][k] = q.m[k][j] = sums.m[j][k][p];
      ridge += kPrior * std::max(0.0, q.m[k][k]) / n;
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
