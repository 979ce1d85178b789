#include "lib/filters/twin_guides/twin_guides.h"

#include <utility>

#include "lib/filters/twin_guides/agreed_light.h"
#include "lib/filters/twin_guides/clean_features.h"
#include "lib/filters/twin_guides/coarser_inputs.h"
#include "lib/filters/twin_guides/guides.h"
#include "lib/filters/twin_guides/opened_limits.h"
#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/filters/twin_guides/scale_blend.h"
#include "lib/filters/twin_guides/tiles.h"
#include "lib/filters/twin_guides/window_fit.h"
#include "lib/filters/twin_guides/window_weights.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/sample_clamp.h"

namespace spool {
namespace {

// The picture of every scale, the finest first.
std::vector<ScaleImages> fit_scales(ScaleInputs inputs, const CountImage& n, GuideLevels finest,
                                    const FeatureImages& clean, const RadianceScale& scale,
                                    const Plane& heavy, const TwinGuidesOptions& options) {
  const int width = n.width(), height = n.height();
  const int count = scale_count(options, width, height);
  std::vector<ScaleImages> scales;
  GuidePyramid pyramid(std::move(finest), scale, options);
  FitOptions fit{options.ridge, options.limit, heavy};
  for (int k = 0; k < count; ++k) {
    if (k > 0) {
      pyramid.coarsen();
      fit.ridge *= kRidgeOfCoarser;
    }
    const bool last = k + 1 == count;
    ScaleInputs next = last ? ScaleInputs{} : empty_inputs(width, height, inputs.features.size());
    scales.push_back(empty_images(width, height));
    const auto on_tile = [&](const Lattice& lattice, const Rectangle& tile) {
      const WindowWeights weights(lattice, tile, {options.radius, options.sigma}, pyramid, clean,
                                  options);
      const FitTable table(lattice, tile, options.radius, inputs);
      window_fit(lattice, tile, weights, table, inputs, clean, n, fit, scales.back());
      if (!last) coarser_inputs(lattice, tile, weights, options.sigma, table, inputs, next);
    };
    parallel_lattice_tiles(width, height, pyramid.step(), on_tile);
    inputs = std::move(next);
  }
  return scales;
}

}  // namespace

Result<Reconstruction> reconstruct_twin_guides(const Selection& selection, const SamplePool& pool,
                                               const TwinGuidesOptions& options,
                                               const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  const CountImage& n = statistics.n;
  SPOOL_TRY(check_any_sample(n));
  Reconstruction result;
  for (const std::int32_t k : n.pixels())
    result.guards.add(Guard::kEmptyPiece, k == 0 ? 1 : 0);
  const RadianceScale scale = radiance_scale(statistics, result.guards);
  OpenedLimits opened =
      open_limits(sample_limits(pool, n, scale.mean / scale.unit, {.sigma = options.clamp_sigma}),
                  pool, n, options);
  const NoisePool noise_pool{options.noise_pool, opened.heavy};
  SampleMoments moments = sample_moments(pool, n, opened.limits, noise_pool, scale, result.guards);
  opened.limits = {};
  SPOOL_ASSIGN(CleanFeatures features, clean_features(pool, n, result.guards));

  GuideLevels finest = guide_levels(guide_sources(moments, features.clean), n, scale, options);
  const AgreedLight agreed = agreed_light(std::move(moments.clamped_light), options.agreement);
  const std::vector<ScaleImages> scales = fit_scales(
      finest_inputs(std::move(moments), std::move(features.raw)), n,
      {noise_pool.unused() ? std::move(finest.fine) : finest.fine, finest.coarse, finest.slack},
      features.clean, scale, opened.heavy, options);
  const FloatRgb blended = return_agreed_light(
      blend_scales(scales, std::move(finest), features.clean, noise_pool, scale, options), agreed,
      options.agreement, scale);

  RgbImage image = make_rgb(n.width(), n.height());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i)
      image[c][i] = blended[c][i] / scale.unit;
  }
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

Filter twin_guides_filter() {
  return make_value<FilterFunction, TwinGuidesOptions>(
      {.name = "twin_guides",
       .summary =
           "local regression on position and features, weights from two guides of the samples",
       .options = twin_guides_option_table(),
       .presets = {{"robust", {}}, {"heavy_tails", heavy_tailed_twin_guides_options()}},
       .needs =
           [](const auto&) {
             return Needs{.features = Use::kWhenRecorded, .signal = false, .variance = false};
           },
       .memory = {546, 5e6},
       .memory_of_means = {{482, 5e6}},
       .cost = 2.7,
       .run = reconstruct_twin_guides});
}

}  // namespace spool
