#include "lib/filters/twin_guides/opened_limits.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr int kMostGroups = 4;
constexpr double kHeavyBegins = 0.25;  // in units of the ratio at which tails are heavy

// min(4, smallest count of a pixel that has samples).
int groups_of_pixels(const CountImage& n, int q) {
  int groups = kMostGroups;
  for (int y = 0; y < n.height(); y += q) {
    for (int x = 0; x < n.width(); x += q) {
      int count = 0;
      for (int i = 0; i < q * q; ++i)
        count += n(x + i % q, y + i / q);
      if (count > 0) groups = std::min(groups, count);
    }
  }
  return groups;
}

struct Split {
  std::vector<Plane> taken;  // [group], mean luminance above the limit
  Plane kept;                // mean luminance below it
};

// 0 .. 1. `ratio`: agreed light over kept light.
double heaviness(double ratio, double heavy) {
  if (heavy == 0.0) return ratio > 0.0 ? 1.0 : 0.0;
  return std::clamp((ratio / heavy - kHeavyBegins) / (1.0 - kHeavyBegins), 0.0, 1.0);
}

Split split_at(const Plane& limits, const SamplePool& pool, const CountImage& n, int groups) {
  const int q = pool.pieces_per_side();
  Split split{std::vector<Plane>(static_cast<std::size_t>(groups), limits), limits};
  parallel_rows(0, limits.height(), [&](int y) {
    for (int x = 0; x < limits.width(); ++x) {
      const double limit = limits(x, y);
      std::array<double, kMostGroups> above{};
      double below = 0.0;
      int position = 0;
      for (int piece = 0; piece < q * q; ++piece) {
        const int px = x * q + piece % q, py = y * q + piece / q;
        for (int i = 0; i < n(px, py); ++i, ++position) {
          const Rgb sample = pool.sample(px, py, i);
          const double l = luminance(sample[0], sample[1], sample[2]);
          if (l > limit) above[static_cast<std::size_t>(position % groups)] += l - limit;
          below += std::min(l, limit);
        }
      }
      for (int k = 0; k < groups; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const int of_group = (position - k + groups - 1) / groups;
        split.taken[at](x, y) = of_group > 0 ? above[at] / of_group : 0.0;
      }
      split.kept(x, y) = position > 0 ? below / position : 0.0;
    }
  });
  return split;
}

// The value of a pixel in each of its pieces.
Plane pieces_of_pixels(const Plane& pixels, int q) {
  Plane pieces(pixels.width() * q, pixels.height() * q);
  for (int y = 0; y < pieces.height(); ++y) {
    for (int x = 0; x < pieces.width(); ++x)
      pieces(x, y) = pixels(x / q, y / q);
  }
  return pieces;
}

}  // namespace

OpenedLimits open_limits(Plane limits, const SamplePool& pool, const CountImage& n,
                         const TwinGuidesOptions& options) {
  const int groups = groups_of_pixels(n, pool.pieces_per_side());
  if (options.opening <= 0.0 || groups < 2) return {std::move(limits), {}};
  Split split = split_at(limits, pool, n, groups);
  const Taps taps = four_sigma_taps(options.clamp_sigma);
  const Plane kept = convolve(split.kept, taps);
  Plane agreed = convolve(split.taken[0], taps);
  for (std::size_t k = 1; k < split.taken.size(); ++k) {
    const Plane around = convolve(split.taken[k], taps);
    for (std::size_t i = 0; i < agreed.size(); ++i)
      agreed[i] = std::min(agreed[i], around[i]);
  }
  Plane heavy(limits.width(), limits.height());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double ratio = kept[i] > 0.0 ? agreed[i] / kept[i] : 0.0;
    heavy[i] = heaviness(ratio, options.heavy);
    limits[i] *= 1.0 + options.opening * heavy[i] * ratio;
  }
  if (std::ranges::all_of(heavy.pixels(), [](double h) { return h == 0.0; }))
    return {std::move(limits), {}};
  return {std::move(limits), pieces_of_pixels(heavy, pool.pieces_per_side())};
}

}  // namespace spool
