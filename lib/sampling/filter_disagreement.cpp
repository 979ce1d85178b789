#include "lib/sampling/filter_disagreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"
#include "lib/sampling/rounds.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 0.01;  // in squared units of the exposed radiance

Plane filtered_difference(const RgbImage& a, const RgbImage& b, double exposure) {
  Plane error(a[0].width(), a[0].height());
  parallel_rows(0, error.height(), [&](int y) {
    for (int x = 0; x < error.width(); ++x) {
      double sum = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double fa = exposure * a[c](x, y), fb = exposure * b[c](x, y);
        const double f = 0.5 * (fa + fb);
        sum += (fa - fb) * (fa - fb) / (f * f + kRelativeFloor);
      }
      error(x, y) = sum / 3.0;
    }
  });
  return error;
}

}  // namespace

CountImage hand_out_deficits(const Plane& weight, const CountImage& n, const SamplePool& pool,
                             long long share) {
  const auto counted = [&](std::size_t i) {
    return std::isgreater(weight[i], 0.0) ? weight[i] : 0.0;  // nor NaN
  };
  const double sum = pairwise_sum(weight.size(), counted);
  const auto all = static_cast<double>(count_samples(n) + share);
  Plane deficit(n.width(), n.height());
  parallel_for(n.size(), [&](std::size_t i) {
    const double worth = sum > 0.0 ? counted(i) / sum * all : 0.0;
    deficit[i] = std::max(worth - n[i], 0.0);
  });
  return hand_out(deficit, n, pool, share);
}

Plane pixels_to_pieces(const Plane& pixels, int pieces_per_side) {
  const int q = pieces_per_side;
  Plane pieces(pixels.width() * q, pixels.height() * q);
  parallel_rows(0, pieces.height(), [&](int y) {
    for (int x = 0; x < pieces.width(); ++x)
      pieces(x, y) = pixels(x / q, y / q) / (q * q);
  });
  return pieces;
}

Result<Plane> filter_disagreement(const PieceStatistics& statistics, const SamplePool& pool,
                                  const LoopFilter& filter, double blur, Plane* error) {
  std::array<RgbImage, 2> filtered;
  for (int parity = 0; parity < 2; ++parity) {
    const SamplePool half_pool = pool.half(parity);
    Selection half;
    half.statistics = half_statistics(statistics, half_pool, parity);
    SPOOL_ASSIGN(filtered[static_cast<std::size_t>(parity)], filter(half, half_pool));
  }
  Plane weight = filtered_difference(filtered[0], filtered[1], statistics.signal.exposure);
  if (error != nullptr) *error = weight;
  weight = gaussian_blur(weight, blur);
  parallel_for(weight.size(),
               [&](std::size_t i) { weight[i] = std::sqrt(std::max(weight[i], 0.0)); });
  return weight;
}

Result<void> check_loop(const SamplingContext& context, std::string_view sampler) {
  if (context.filter) return {};
  return fail(ErrorCode::kUsage,
              "sampler {}: needs the filter of the final image in its loop: name it with --filter",
              sampler);
}

}  // namespace spool
