#include "lib/filters/twin_guides/opened_limits.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/kernels/event_places.h"
#include "lib/kernels/sample_clamp.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kHeavyBegins = 0.25;  // in units of the ratio at which tails are heavy
constexpr double kHeavyOfPool = 2.0;   // ratio at which noise is pooled, in the same units

// Places of the samples above the limit, of kPlace pixels. Up to the first correlation light falls
// anywhere alike, from the second on it has places; up to the first density a pixel is beside them.
constexpr double kPlace = 1.5, kAnywhere = 1.2, kInPlaces = 1.7;
constexpr double kBeside = 1.0, kInside = 2.0;

// Mean over the pixels that have any.
double mean_count(const CountImage& of_pixel) {
  std::int64_t samples = 0, pixels = 0;
  for (const std::int32_t count : of_pixel.pixels()) {
    samples += count;
    pixels += count > 0 ? 1 : 0;
  }
  return static_cast<double>(samples) / static_cast<double>(pixels);
}

struct Split {
  std::vector<Plane> taken;  // [group], mean luminance above the limit
  std::vector<Plane> share;  // [group], of the samples above it
  Plane kept;                // mean luminance below it
};

double ramp(double value, double from, double to) {
  return std::clamp((value - from) / (to - from), 0.0, 1.0);
}

// 0 .. 1. `ratio`: agreed light over kept light.
double heaviness(double ratio, double heavy) {
  if (heavy == 0.0) return ratio > 0.0 ? 1.0 : 0.0;
  return ramp(ratio / heavy, kHeavyBegins, 1.0);
}

// 0 .. 1. Beside a lamp there is nothing to pool: its noise is not that of what is around it.
double has_the_light(double correlation, double density) {
  return std::max(ramp(correlation, kInPlaces, kAnywhere), ramp(density, kBeside, kInside));
}

Split split_at(const Plane& limits, const SamplePool& pool, const CountImage& n, int groups) {
  const int q = pool.pieces_per_side();
  const std::vector<Plane> of_groups(static_cast<std::size_t>(groups), limits);
  Split split{of_groups, of_groups, limits};
  parallel_rows(0, limits.height(), [&](int y) {
    for (int x = 0; x < limits.width(); ++x) {
      const double limit = limits(x, y);
      std::array<double, kMostSampleGroups> above{}, samples_above{};
      double below = 0.0;
      int position = 0;
      for (int piece = 0; piece < q * q; ++piece) {
        const int px = x * q + piece % q, py = y * q + piece / q;
        for (int i = 0; i < n(px, py); ++i, ++position) {
          const Rgb sample = pool.sample(px, py, i);
          const double l = luminance(sample[0], sample[1], sample[2]);
          if (l > limit) {
            const auto group = static_cast<std::size_t>(position % groups);
            above[group] += l - limit;
            samples_above[group] += 1.0;
          }
          below += std::min(l, limit);
        }
      }
      for (int k = 0; k < groups; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const int of_group = (position - k + groups - 1) / groups;
        split.taken[at](x, y) = of_group > 0 ? above[at] / of_group : 0.0;
        split.share[at](x, y) = of_group > 0 ? samples_above[at] / of_group : 0.0;
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
  const CountImage of_pixel = samples_of_pixels(n, pool.pieces_per_side());
  const int groups = number_of_groups(of_pixel);
  if (options.opening <= 0.0 || groups < 2) return {std::move(limits), {}};
  const Split split = split_at(limits, pool, n, groups);
  const Taps taps = four_sigma_taps(options.clamp_sigma);
  const Plane kept = convolve(split.kept, taps);
  Plane agreed = convolve(split.taken[0], taps);
  for (std::size_t k = 1; k < split.taken.size(); ++k) {
    const Plane around = convolve(split.taken[k], taps);
    for (std::size_t i = 0; i < agreed.size(); ++i)
      agreed[i] = std::min(agreed[i], around[i]);
  }
  const EventPlaces places =
      event_places(split.share, kPlace, options.clamp_sigma, mean_count(of_pixel) / groups);
  Plane heavy(limits.width(), limits.height());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double ratio = kept[i] > 0.0 ? agreed[i] / kept[i] : 0.0;
    limits[i] *= 1.0 + options.opening * heaviness(ratio, options.heavy) * ratio;
    heavy[i] = heaviness(ratio, kHeavyOfPool * options.heavy) *
               has_the_light(places.correlation[i], places.density[i]);
  }
  if (std::ranges::all_of(heavy.pixels(), [](double h) { return h == 0.0; }))
    return {std::move(limits), {}};
  return {std::move(limits), pieces_of_pixels(heavy, pool.pieces_per_side())};
}

}  // namespace spool
