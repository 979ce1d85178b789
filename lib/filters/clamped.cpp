#include "lib/filters/clamped.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

// Mean over the other pixels of the window; nothing where there are none.
std::optional<double> mean_of_neighbours(const Plane& image, int x, int y) {
  const Rectangle window = intersect({x - 1, y - 1, x + 2, y + 2}, image.bounds());
  if (window.area() < 2) return std::nullopt;
  double sum = 0.0;
  for (int py = window.y0; py < window.y1; ++py) {
    for (int px = window.x0; px < window.x1; ++px) {
      if (px != x || py != y) sum += image(px, py);
    }
  }
  return sum / static_cast<double>(window.area() - 1);
}

struct BrightSample {
  int x = 0, y = 0, i = 0;  // piece, and which of it
  Rgb value{};
  double luminance = 0.0;
};

// The sample of largest luminance of pixel (x, y), the first of equal ones.
std::optional<BrightSample> brightest(const SamplePool& pool, const CountImage& n, int x, int y) {
  std::optional<BrightSample> found;
  const int q = pool.pieces_per_side();
  for (int py = y * q; py < (y + 1) * q; ++py) {
    for (int px = x * q; px < (x + 1) * q; ++px) {
      for (int i = 0; i < n(px, py); ++i) {
        const Rgb value = pool.sample(px, py, i);
        const double bright = luminance(value[0], value[1], value[2]);
        if (!found || bright > found->luminance) found = BrightSample{px, py, i, value, bright};
      }
    }
  }
  return found;
}

// What a sample counts in the mean of its piece.
double share_of(const BrightSample& sample, const Selection& selection) {
  const auto samples = [&](const Selection& of) { return of.statistics.n(sample.x, sample.y); };
  if (selection.halves_use == HalvesUse::kTogether) {
    const int even = samples(selection.halves[0]), odd = samples(selection.halves[1]);
    const int own = half_of_joined(even, odd, sample.i) == 0 ? even : odd;
    if (even > 0 && odd > 0) return 0.5 / own;
  }
  return 1.0 / samples(selection);
}

}  // namespace

Result<Reconstruction> reconstruct_clamped(const Selection& selection, const SamplePool& pool,
                                           const ClampedOptions& options, const FilterContext&) {
  SPOOL_TRY(check_any_sample(selection.statistics.n));
  Reconstruction result;
  GuardCounts counted_below;  // empty pieces
  const RgbImage mean = pixel_means(selection.statistics, counted_below);
  Plane bright(mean[0].width(), mean[0].height());
  for (std::size_t i = 0; i < bright.size(); ++i)
    bright[i] = luminance(mean[0][i], mean[1][i], mean[2][i]);
  PieceStatistics limited = selection.statistics;
  std::vector<std::uint64_t> clamped(static_cast<std::size_t>(bright.height()), 0);
  parallel_rows(0, bright.height(), [&](int y) {
    for (int x = 0; x < bright.width(); ++x) {
      const std::optional<double> around = mean_of_neighbours(bright, x, y);
      const std::optional<BrightSample> sample = brightest(pool, limited.n, x, y);
      if (!around || !sample) continue;
      const double limit = options.factor * std::max(*around, 0.0);
      if (sample->luminance <= limit) continue;
      ++clamped[static_cast<std::size_t>(y)];
      const double taken = (limit / sample->luminance - 1.0) * share_of(*sample, selection);
      for (std::size_t c = 0; c < 3; ++c)
        limited.mean[c](sample->x, sample->y) += sample->value[c] * taken;
    }
  });
  for (const std::uint64_t of_row : clamped)
    result.guards.add(Guard::kClampedSample, of_row);
  result.image = pixel_means(limited, result.guards);
  return result;
}

Filter clamped_filter() {
  using O = ClampedOptions;
  return make_value<FilterFunction, O>(
      {.name = "clamped",
       .summary = "control: box with the brightest sample of a pixel limited by its neighbours",
       .options =
           {
               number_option("factor", &O::factor, 0.0, 1e6,
                             "largest sample of a pixel in units of its neighbours' mean"),
           },
       .cost = 0.17,
       .run = reconstruct_clamped});
}

}  // namespace spool
