#include "lib/filters/box.h"

#include <utility>

#include "lib/kernels/piece_estimates.h"

namespace spool {

Result<Reconstruction> reconstruct_box(const Selection& selection, const SamplePool&,
                                       const BoxOptions&, const FilterContext& context) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  PieceEstimates pieces;
  if (context.variance) {
    const double exposure = analysis_exposure(statistics, result.guards);
    SPOOL_ASSIGN(pieces, estimate_pieces(statistics, {}, exposure, result.guards));
  } else {
    SPOOL_ASSIGN(pieces.mean, estimate_means(statistics, result.guards));
    pieces.n = statistics.n;
  }
  const int q = statistics.pieces_per_side;
  for (const auto& [x, y] : wanted_pixels(context)) {
    Footprint footprint{x, y, {}, {}};
    for (int i = 0; i < q * q; ++i)
      footprint.add(x, y, 1.0 / (q * q), pieces.mean, pieces.n.index(x * q + i % q, y * q + i / q));
    context.footprints->add(std::move(footprint));
  }
  result.image = average_pieces(std::move(pieces.mean), q);
  if (context.variance) result.variance = average_piece_variance(std::move(pieces.variance), q);
  return result;
}

Filter box_filter() {
  return make_value<FilterFunction, BoxOptions>(
      {.name = "box",
       .summary = "mean of each pixel's samples, no filter",
       .needs =
           [](const auto&) { return Needs{.signal = false, .variance = false, .pool = false}; },
       .memory = {188, 2e6},
       .memory_of_means = {{81, 2e6}},
       .cost = 0.013,
       .footprints = true,
       .run = reconstruct_box});
}

}  // namespace spool
