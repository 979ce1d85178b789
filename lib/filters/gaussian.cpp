#include "lib/filters/gaussian.h"

#include "lib/filters/box.h"
#include "lib/pyramid/convolution.h"

namespace spool {

OptionTable<GaussianOptions> gaussian_option_table() {
  return {
      number_option("sigma", &GaussianOptions::sigma, 0.0, 64.0,
                    "standard deviation in pixels; 0 is the box filter"),
  };
}

Result<Reconstruction> reconstruct_gaussian(const Selection& selection, const SamplePool& pool,
                                            const GaussianOptions& options,
                                            const FilterContext& context) {
  SPOOL_ASSIGN(Reconstruction result, reconstruct_box(selection, pool, {}, context));
  const Taps taps = gaussian_taps(options.sigma);
  Taps squares = taps;
  for (double& tap : squares.values)
    tap *= tap;
  for (std::size_t c = 0; c < 3; ++c) {
    result.image[c] = convolve(result.image[c], taps);
    (*result.variance)[c] = convolve((*result.variance)[c], squares);
  }
  return result;
}

Filter gaussian_filter() {
  return make_value<FilterFunction, GaussianOptions>(
      {.name = "gaussian",
       .summary = "pixel means blurred with a Gaussian",
       .options = gaussian_option_table(),
       .memory = {188, 2e6},
       .run = reconstruct_gaussian});
}

}  // namespace spool
