#include "lib/filters/wavelet_shrinkage.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"

namespace spool {
namespace {

void shrink_band(Plane& coefficients, const Plane& variance, const Rectangle& band, double lambda) {
  if (lambda == 0.0) return;
  parallel_rows(band.y0, band.y1, [&](int y) {
    for (int x = band.x0; x < band.x1; ++x) {
      const double v = variance(x, y);
      double& w = coefficients(x, y);
      if (!(v > 0.0)) continue;
      w = std::copysign(std::max(0.0, std::abs(w) - lambda * std::sqrt(v)), w);
    }
  });
}

// What was kept of each coefficient.
Plane kept_share(const Plane& after, const Plane& before) {
  Plane kept(after.width(), after.height());
  for (std::size_t i = 0; i < kept.size(); ++i)
    kept[i] = before[i] == 0.0 ? 0.0 : after[i] / before[i];
  return kept;
}

// One channel of the footprint. Where each coefficient keeps a given share of itself the filter is
// linear: the pixel's row of its matrix is found by the transposed transforms.
void add_channel(const Plane& kept, const RgbImage& mean, std::size_t c, int levels,
                 Footprint& to) {
  Plane row(kept.width(), kept.height());
  row(to.x, to.y) = 1.0;
  transposed_inverse_transform(row, levels);
  for (std::size_t i = 0; i < row.size(); ++i)
    row[i] *= kept[i];
  transposed_forward_transform(row, levels);
  for (int y = 0; y < row.height(); ++y) {
    for (int x = 0; x < row.width(); ++x) {
      if (row(x, y) == 0.0) continue;
      const int from_x = extend_symmetric(x, mean[c].width());
      const int from_y = extend_symmetric(y, mean[c].height());
      FootprintTap& tap = to.taps[{from_y, from_x}];
      tap.weight += row(x, y) / 3.0;
      tap.weighted[c] += row(x, y) * mean[c](from_x, from_y);
    }
  }
}

OptionTable<WaveletShrinkageOptions> wavelet_shrinkage_option_table() {
  using O = WaveletShrinkageOptions;
  return {
      integer_option<O>("levels", &O::levels, 1, 8, "levels of the transform"),
      number_option<O>("lambda", &O::lambda, 0.0, 100.0,
                       "threshold in standard deviations of a coefficient; 0 changes nothing"),
  };
}

}  // namespace

Result<Reconstruction> reconstruct_wavelet_shrinkage(const Selection& selection, const SamplePool&,
                                                     const WaveletShrinkageOptions& options,
                                                     const FilterContext& context) {
  const PieceStatistics& statistics = selection.statistics;
  const int q = statistics.pieces_per_side;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  SPOOL_ASSIGN(PieceEstimates pieces, estimate_pieces(statistics, {}, exposure, result.guards));
  const RgbImage mean = average_pieces(std::move(pieces.mean), q);
  const RgbImage variance = average_piece_variance(std::move(pieces.variance), q);
  result.image = make_rgb(mean[0].width(), mean[0].height());
  std::vector<Footprint> footprints;
  for (const auto& [x, y] : wanted_pixels(context))
    footprints.push_back({x, y, {}, {}});
  for (std::size_t c = 0; c < 3; ++c) {
    Plane w = padded_for_transform(mean[c], options.levels);
    Plane v = padded_for_transform(variance[c], options.levels);
    forward_transform(w, options.levels, TransformOf::kValues);
    forward_transform(v, options.levels, TransformOf::kVariances);
    const Plane before = footprints.empty() ? Plane{} : w;
    for (int l = 0; l < options.levels; ++l) {
      const int width = w.width() >> l, height = w.height() >> l;
      shrink_band(w, v, {width / 2, 0, width, height / 2}, options.lambda);
      shrink_band(w, v, {0, height / 2, width / 2, height}, options.lambda);
      shrink_band(w, v, {width / 2, height / 2, width, height}, options.lambda);
    }
    if (!footprints.empty()) {
      const Plane kept = kept_share(w, before);
      for (Footprint& footprint : footprints)
        add_channel(kept, mean, c, options.levels, footprint);
    }
    inverse_transform(w, options.levels);
    parallel_rows(0, mean[c].height(), [&](int y) {
      std::copy_n(w.row(y).data(), mean[c].width(), result.image[c].row(y).data());
    });
  }
  for (Footprint& footprint : footprints)
    context.footprints->add(std::move(footprint));
  return result;
}

Filter wavelet_shrinkage_filter() {
  return make_value<FilterFunction, WaveletShrinkageOptions>(
      {.name = "wavelet_shrinkage",
       .summary = "wavelet coefficients reduced by an estimate of their error",
       .source = Source::kDescriptions,
       .options = wavelet_shrinkage_option_table(),
       .memory = {180, 2e6},
       .cost = 0.36,
       .footprints = true,
       .run = reconstruct_wavelet_shrinkage});
}

}  // namespace spool
