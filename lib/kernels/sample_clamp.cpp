#include "lib/kernels/sample_clamp.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/scene_luminance.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

// visit(luminance) for the samples taken of pixel (x, y), in the order of their positions.
template <class Visit>
void visit_luminances(const SamplePool& pool, const CountImage& n, int x, int y, Visit&& visit) {
  const int q = pool.pieces_per_side();
  for (int py = y * q; py < (y + 1) * q; ++py) {
    for (int px = x * q; px < (x + 1) * q; ++px) {
      for (int i = 0; i < n(px, py); ++i) {
        const Rgb value = pool.sample(px, py, i);
        visit(luminance(value[0], value[1], value[2]));
      }
    }
  }
}

struct GroupMeans {
  std::vector<Plane> mean;  // [group][y][x]; 0 where a pixel has no samples
  Plane own;                // mean without the largest sample
};

GroupMeans group_means(const SamplePool& pool, const CountImage& n, const CountImage& of_pixel,
                       int groups) {
  const int width = of_pixel.width(), height = of_pixel.height();
  GroupMeans result{std::vector<Plane>(static_cast<std::size_t>(groups), Plane(width, height)),
                    Plane(width, height)};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (of_pixel(x, y) == 0) continue;
      std::array<double, kMostSampleGroups> sum{};
      double total = 0.0, largest = 0.0;
      int position = 0;
      visit_luminances(pool, n, x, y, [&](double value) {
        sum[static_cast<std::size_t>(position % groups)] += value;
        total += value;
        largest = position == 0 ? value : std::max(largest, value);
        ++position;
      });
      for (int k = 0; k < groups; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const int taken = (position - k + groups - 1) / groups;
        result.mean[at](x, y) = sum[at] / taken;
      }
      result.own(x, y) = (total - largest) / std::max(position - 1, 1);
    }
  });
  return result;
}

// Of an even number of values the mean of the two in the middle.
double median(std::array<double, kMostSampleGroups> values, int count) {
  for (auto it = values.begin(); it != values.begin() + count; ++it)
    std::rotate(std::upper_bound(values.begin(), it, *it), it, it + 1);
  const auto middle = static_cast<std::size_t>(count / 2);
  return count % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

std::uint64_t samples_above(const SamplePool& pool, const CountImage& n, const Plane& limits) {
  std::vector<std::uint64_t> above(static_cast<std::size_t>(limits.height()), 0);
  parallel_rows(0, limits.height(), [&](int y) {
    for (int x = 0; x < limits.width(); ++x) {
      visit_luminances(pool, n, x, y, [&](double value) {
        if (value > limits(x, y)) ++above[static_cast<std::size_t>(y)];
      });
    }
  });
  std::uint64_t sum = 0;
  for (const std::uint64_t of_row : above)
    sum += of_row;
  return sum;
}

}  // namespace

CountImage samples_of_pixels(const CountImage& n, int q) {
  CountImage of_pixel(n.width() / q, n.height() / q);
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      of_pixel(x / q, y / q) += n(x, y);
  }
  return of_pixel;
}

int number_of_groups(const CountImage& n) {
  int groups = kMostSampleGroups;
  for (const std::int32_t count : n.pixels()) {
    if (count > 0) groups = std::min(groups, count);
  }
  return groups;
}

Plane sample_limits(const SamplePool& pool, const CountImage& n, double unit,
                    const SampleClampOptions& options) {
  const CountImage of_pixel = samples_of_pixels(n, pool.pieces_per_side());
  const int groups = number_of_groups(of_pixel);
  GroupMeans means = group_means(pool, n, of_pixel, groups);
  const Taps taps = four_sigma_taps(options.sigma);
  GuardCounts counted_by_the_filter;  // pixels without samples
  for (Plane& mean : means.mean) {
    mean = convolve(fill_empty_pieces(std::move(mean), of_pixel, 1, counted_by_the_filter), taps);
  }
  Plane limits(of_pixel.width(), of_pixel.height());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    std::array<double, kMostSampleGroups> around{};
    for (std::size_t k = 0; k < means.mean.size(); ++k)
      around[k] = means.mean[k][i];
    const double expected = std::max({median(around, groups), means.own[i], 0.0});
    limits[i] =
        std::max(options.kappa, static_cast<double>(of_pixel[i])) * expected + options.floor * unit;
  }
  return limits;
}

ClampedSamples clamp_samples(const Selection& selection, const SamplePool& pool,
                             const SampleClampOptions& options, GuardCounts& guards) {
  const PieceStatistics& taken = selection.statistics;
  Plane limits = sample_limits(pool, taken.n, scene_luminance(taken, guards), options);
  guards.add(Guard::kClampedSample, samples_above(pool, taken.n, limits));
  SamplePool clamped = pool.with_limits(std::move(limits));
  Selection seen{
      prefix_statistics(clamped, taken.n, taken.signal, taken.channel_minimum.has_value()),
      selection.attenuation};
  if (selection.halves_use == HalvesUse::kTogether)
    weigh_halves_alike(seen.statistics, clamped, selection.halves[0].statistics.n,
                       selection.halves[1].statistics.n);
  return {std::move(clamped), std::move(seen)};
}

}  // namespace spool
