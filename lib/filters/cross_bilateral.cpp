#include "lib/filters/cross_bilateral.h"

#include <utility>

#include "lib/kernels/piece_estimates.h"

namespace spool {

const Presets<CrossBilateralOptions>& cross_bilateral_presets() {
  static const Presets<CrossBilateralOptions> presets = [] {
    CrossBilateralOptions paper;
    paper.scales = {0, 1, 2, 4, 8};
    paper.risk_scale = 8.0;
    CrossBilateralOptions patches = paper;
    patches.range = CrossRange::kPatches;
    patches.risk_scale = 4.0;
    return Presets<CrossBilateralOptions>{
        {"robust", {}}, {"paper", paper}, {"cross_nl_means", patches}};
  }();
  return presets;
}

Result<Reconstruction> reconstruct_cross_bilateral(const Selection& selection,
                                                   const SamplePool& pool,
                                                   const CrossBilateralOptions& options,
                                                   const FilterContext& context) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  const bool shown = context.views != nullptr && context.views->wants("risk");
  SPOOL_ASSIGN(
      CrossBilateralImage filtered,
      cross_bilateral(statistics, pool, exposure, options, result.guards,
                      shown ? RisksKept::kAll : RisksKept::kOfTheScale, context.footprints));
  if (context.views != nullptr) {
    for (std::size_t s = 0; s < filtered.all.size(); ++s)
      context.views->add(fmt::format("risk.{}", s), filtered.all[s]);
  }
  result.image = average_pieces(std::move(filtered.image), statistics.pieces_per_side);
  result.level = std::move(filtered.scale);
  if (context.progress) context.progress(1.0);
  return result;
}

Filter cross_bilateral_filter() {
  return make_value<FilterFunction, CrossBilateralOptions>(
      {.name = "cross_bilateral",
       .summary =
           "pixels of like normal, albedo and depth are averaged, over the scale of least risk",
       .options = cross_bilateral_option_table(),
       .presets = cross_bilateral_presets(),
       .views = {{"risk.s", "smoothed estimate of the risk of scale s"}},
       .needs = [](const auto&) { return Needs{.features = Use::kRequired}; },
       .memory = {264, 6.4e6},
       .cost = 3.8,
       .footprints = true,
       .run = reconstruct_cross_bilateral});
}

}  // namespace spool
