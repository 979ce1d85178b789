#include "lib/filters/nl_means.h"

#include <algorithm>
#include <array>
#include <optional>

#include "lib/kernels/kernel_footprint.h"
#include "lib/kernels/piece_estimates.h"

namespace spool {
namespace {

GuidedTargets guided_by(const SampleHalf& half, const SampleHalf& other) {
  const RgbImage& mean = half.image.mean;
  return {{&mean[0], &mean[1], &mean[2]}, &other.image};
}

// What a half adds to a pixel: its weight in the mean of both, times the weights of its pieces.
struct HalfShare {
  const SampleHalf& half;
  const SampleHalf& guide;
  int least;  // samples it counts for at least
};

void add_half(const HalfShare& share, const HalfShare& other, const PatchFilterOptions& options,
              double exposure, int q, Footprint& to) {
  for (int i = 0; i < q * q; ++i) {
    const int x = to.x * q + i % q, y = to.y * q + i / q;
    const double mine = std::max(share.least, share.half.n(x, y));
    const double all = mine + std::max(other.least, other.half.n(x, y));
    for (const PatchWeight& piece : patch_weights(share.guide.image, options, x, y)) {
      if (piece.weight == 0.0) continue;
      const RgbImage& mean = share.half.image.mean;
      to.add(piece.x / q, piece.y / q, mine / all / (q * q) * piece.weight, mean,
             mean[0].index(piece.x, piece.y), 1.0 / exposure);
    }
  }
}

OptionTable<NlMeansOptions> nl_means_option_table() {
  using O = NlMeansOptions;
  OptionTable<O> table;
  append_options(table, patch_filter_option_table(), &O::filter);
  table.push_back(expert(half_variance_option(&O::var_mode)));
  return table;
}

// robust; paper: kappa = 0.45, and the variance of a half by its own samples.
const Presets<NlMeansOptions>& nl_means_presets() {
  static const Presets<NlMeansOptions> presets = [] {
    NlMeansOptions paper;
    paper.filter.kappa = 0.45;
    paper.var_mode = HalfVariance::kRaw;
    return Presets<NlMeansOptions>{{"robust", {}}, {"paper", paper}};
  }();
  return presets;
}

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const NlMeansOptions& options,
                                            const FilterContext& context) {
  const PieceStatistics& statistics = selection.statistics;
  SPOOL_TRY(check_any_sample(statistics.n));
  Reconstruction result;
  for (const std::int32_t n : statistics.n.pixels())
    result.guards.add(Guard::kEmptyPiece, n == 0 ? 1 : 0);
  const double exposure = analysis_exposure(statistics, result.guards);
  const bool crossed = std::any_of(statistics.n.pixels().begin(), statistics.n.pixels().end(),
                                   [](std::int32_t n) { return n > 1; });
  SPOOL_ASSIGN(const SampleHalf a, sample_half(statistics, pool, 0, options.var_mode, exposure));
  std::optional<SampleHalf> odd;
  if (crossed) {
    SPOOL_ASSIGN(odd, sample_half(statistics, pool, 1, options.var_mode, exposure));
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
  for (const auto& [x, y] : wanted_pixels(context)) {
    Footprint footprint{x, y, {}, {}};
    const HalfShare even{a, b, 1}, uneven{b, a, 0};
    add_half(even, uneven, options.filter, exposure, statistics.pieces_per_side, footprint);
    add_half(uneven, even, options.filter, exposure, statistics.pieces_per_side, footprint);
    context.footprints->add(std::move(footprint));
  }
  return result;
}

}  // namespace

Filter nl_means_filter() {
  return make_value<FilterFunction, NlMeansOptions>(
      {.name = "nl_means",
       .summary =
           "patches that look alike are averaged, weights from the other half of the samples",
       .options = nl_means_option_table(),
       .presets = nl_means_presets(),
       .needs = [](const auto&) { return Needs{.signal = false}; },
       .memory = {215, 4.7e6},
       .cost = 2.35,
       .footprints = true,
       .run = reconstruct_nl_means});
}

}  // namespace spool
