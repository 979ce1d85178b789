#include "lib/filters/twin_guides/twin_guides.h"

#include <algorithm>
#include <utility>

#include "lib/filters/twin_guides/clean_features.h"
#include "lib/filters/twin_guides/guides.h"
#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/filters/twin_guides/tiles.h"
#include "lib/filters/twin_guides/window_fit.h"
#include "lib/filters/twin_guides/window_weights.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/sample_clamp.h"

namespace spool {

Result<Reconstruction> reconstruct_twin_guides(const Selection& selection, const SamplePool& pool,
                                               const TwinGuidesOptions& options,
                                               const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  const CountImage& n = statistics.n;
  if (std::none_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k > 0; })) {
    return fail(ErrorCode::kData,
                "selection: no piece has a sample: raise the budget or check the counts");
  }
  Reconstruction result;
  for (const std::int32_t k : n.pixels())
    result.guards.add(Guard::kEmptyPiece, k == 0 ? 1 : 0);
  const RadianceScale scale = radiance_scale(statistics, result.guards);
  const SampleMoments moments = sample_moments(
      pool, n, sample_limits(pool, n, scale.mean / scale.unit), scale, result.guards);
  SPOOL_ASSIGN(const CleanFeatures features, clean_features(pool, n, result.guards));

  RgbImage image = make_rgb(n.width(), n.height());
  parallel_tiles(n.width(), n.height(), [&](const Rectangle& tile) {
    const int r = options.radius;
    const Rectangle around = {tile.x0 - r, tile.y0 - r, tile.x1 + r, tile.y1 + r};
    const TilePlanes guides = guides_around(around, moments, features.clean, scale, options);
    const WindowWeights weights(tile, guides, features.clean, n.bounds(), options);
    const FloatRgb fitted = window_fit(tile, weights, moments, n, features, options);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x)
          image[c](x, y) = fitted[c](x - tile.x0, y - tile.y0) / scale.unit;
      }
    }
  });
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

Filter twin_guides_filter() {
  return make_value<FilterFunction, TwinGuidesOptions>(
      {.name = "twin_guides",
       .summary =
           "local regression on position and features, weights from two guides of the samples",
       .options = twin_guides_option_table(),
       .needs = [](const auto&) { return Needs{.features = Use::kWhenRecorded}; },
       .run = reconstruct_twin_guides});
}

}  // namespace spool
