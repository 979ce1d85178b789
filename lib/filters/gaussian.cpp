#include "lib/filters/gaussian.h"

#include "lib/core/extend.h"
#include "lib/filters/box.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/convolved_variance.h"

namespace spool {
namespace {

Footprint footprint_of(const Taps& taps, int x, int y, const RgbImage& means) {
  Footprint footprint{x, y, {}, {}};
  const int width = means[0].width(), height = means[0].height();
  for (int j = taps.first; j <= taps.last(); ++j) {
    for (int i = taps.first; i <= taps.last(); ++i) {
      const int from_x = extend_symmetric(x - i, width), from_y = extend_symmetric(y - j, height);
      const double weight = taps.values[static_cast<std::size_t>(i - taps.first)] *
                            taps.values[static_cast<std::size_t>(j - taps.first)];
      footprint.add(from_x, from_y, weight, means, means[0].index(from_x, from_y));
    }
  }
  return footprint;
}

}  // namespace

Result<Reconstruction> reconstruct_gaussian(const Selection& selection, const SamplePool& pool,
                                            const GaussianOptions& options,
                                            const FilterContext& context) {
  FilterContext of_means = context;
  of_means.footprints = nullptr;
  SPOOL_ASSIGN(Reconstruction result, reconstruct_box(selection, pool, {}, of_means));
  const Taps taps = gaussian_taps(options.sigma);
  for (const auto& [x, y] : wanted_pixels(context))
    context.footprints->add(footprint_of(taps, x, y, result.image));
  for (std::size_t c = 0; c < 3; ++c) {
    result.image[c] = convolve(result.image[c], taps);
    if (result.variance) convolve_variance((*result.variance)[c], taps);
  }
  return result;
}

Filter gaussian_filter() {
  using O = GaussianOptions;
  return make_value<FilterFunction, O>(
      {.name = "gaussian",
       .summary = "pixel means blurred with a Gaussian",
       .options =
           {
               number_option("sigma", &O::sigma, 0.0, 64.0,
                             "standard deviation in pixels; 0 is the box filter"),
           },
       .needs =
           [](const auto&) { return Needs{.signal = false, .variance = false, .pool = false}; },
       .memory = {188, 2e6},
       .memory_of_means = {{81, 2e6}},
       .cost = 0.025,
       .footprints = true,
       .run = reconstruct_gaussian});
}

}  // namespace spool
