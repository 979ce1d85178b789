#include "lib/filters/nl_means.h"

#include <algorithm>
#include <array>
#include <optional>

#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/sample_half.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

bool any_sample(const CountImage& n) {
  return std::any_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k > 0; });
}

GuidedTargets guided_by(const SampleHalf& half, const SampleHalf& other) {
  const RgbImage& mean = half.image.mean;
  return {{&mean[0], &mean[1], &mean[2]}, &other.image};
}

}  // namespace

OptionTable<NlMeansOptions> nl_means_option_table() {
  using O = NlMeansOptions;
  OptionTable<O> table;
  append_options(table, patch_filter_option_table(), &O::filter);
  table.push_back(expert(var_mode_option(&O::var_mode)));
  return table;
}

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const NlMeansOptions& options, const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  if (!any_sample(statistics.n)) {
    return fail(ErrorCode::kData,
                "selection: no piece has a sample: raise the budget or check the counts");
  }
  for (const std::int32_t n : statistics.n.pixels())
    result.guards.add(Guard::kEmptyPiece, n == 0 ? 1 : 0);
  const double exposure = analysis_exposure(statistics, result.guards);
  const VarianceOptions variance{options.var_mode};
  const bool crossed = std::any_of(statistics.n.pixels().begin(), statistics.n.pixels().end(),
                                   [](std::int32_t n) { return n > 1; });
  SPOOL_ASSIGN(const SampleHalf a, sample_half(statistics, pool, 0, variance, exposure));
  std::optional<SampleHalf> odd;
  if (crossed) {
    SPOOL_ASSIGN(odd, sample_half(statistics, pool, 1, variance, exposure));
  }
  const SampleHalf& b = odd ? *odd : a;  // one sample a piece: nothing to cross
  RgbImage image = make_rgb(statistics.width(), statistics.height());
  const std::array<GuidedTargets, 2> halves = {guided_by(a, b), guided_by(b, a)};
  filter_tiles(halves, options.filter, [&](const Rectangle& tile, const auto& filtered) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          const double na = std::max(1, a.n(x, y)), nb = b.n(x, y);
          const double fa = filtered[0][c](x - tile.x0, y - tile.y0);
          const double fb = filtered[1][c](x - tile.x0, y - tile.y0);
          image[c](x, y) = (na * fa + nb * fb) / (na + nb) / exposure;
        }
      }
    }
  });
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

Filter nl_means_filter() {
  return make_value<FilterFunction, NlMeansOptions>(
      {.name = "nl_means",
       .summary =
           "patches that look alike are averaged, weights from the other half of the samples",
       .options = nl_means_option_table(),
       .memory = {215, 4.7e6},
       .run = reconstruct_nl_means});
}

}  // namespace spool
