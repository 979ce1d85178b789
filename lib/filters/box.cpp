#include "lib/filters/box.h"

#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/variance_option.h"

namespace spool {

OptionTable<BoxOptions> box_option_table() {
  return {
      var_mode_option(&BoxOptions::var_mode),
      nu0_option(&BoxOptions::nu0),
      number_option("key", &BoxOptions::key, 1e-6, 1e6,
                    "mean luminance that the floor of the variance is written for"),
  };
}

Result<Reconstruction> reconstruct_box(const Selection& selection, const SamplePool&,
                                       const BoxOptions& options, const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, options.key, true, result.guards);
  const VarianceOptions variance{options.var_mode, options.nu0, options.key};
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(statistics, variance, exposure, result.guards));
  const int q = statistics.pieces_per_side;
  result.image = average_pieces(std::move(pieces.mean), q);
  result.variance = average_piece_variance(std::move(pieces.variance), q);
  return result;
}

Filter box_filter() {
  return make_value<FilterFunction, BoxOptions>(
      {.name = "box",
       .summary = "mean of each pixel's samples, no filter",
       .options = box_option_table(),
       .memory = {188, 2e6},
       .run = reconstruct_box});
}

}  // namespace spool
