#include "lib/filters/box.h"

#include "lib/kernels/piece_estimates.h"

namespace spool {

Result<Reconstruction> reconstruct_box(const Selection& selection, const SamplePool&,
                                       const BoxOptions&, const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  SPOOL_ASSIGN(PieceEstimates pieces, estimate_pieces(statistics, {}, exposure, result.guards));
  const int q = statistics.pieces_per_side;
  result.image = average_pieces(std::move(pieces.mean), q);
  result.variance = average_piece_variance(std::move(pieces.variance), q);
  return result;
}

Filter box_filter() {
  return make_value<FilterFunction, BoxOptions>(
      {.name = "box",
       .summary = "mean of each pixel's samples, no filter",
       .memory = {188, 2e6},
       .run = reconstruct_box});
}

}  // namespace spool
