#include "lib/filters/oracle_scale.h"

#include <limits>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/box.h"
#include "lib/filters/greedy_selection.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {

Result<Reconstruction> reconstruct_oracle_scale(const Selection& selection, const SamplePool& pool,
                                                const OracleScaleOptions& options,
                                                const FilterContext& context) {
  SPOOL_ASSIGN(Reconstruction result, reconstruct_box(selection, pool, {}, {}));
  const RgbImage mean = result.image;
  const int width = mean[0].width(), height = mean[0].height();
  if (!context.reference || !context.reference->mean[0].same_size(mean[0])) {
    return fail(ErrorCode::kData,
                "oracle_scale: needs a reference of {} x {} pixels: hand one over, or use a filter "
                "that is not an oracle",
                width, height);
  }
  CountImage level(width, height);
  Plane least(width, height, std::numeric_limits<double>::infinity());
  for (int s = 0; s <= options.scales; ++s) {
    RgbImage candidate;
    Plane error(width, height);
    const Taps taps = s == 0 ? Taps{0, {1.0}} : floor_gaussian_taps(greedy_scale(s));
    for (std::size_t c = 0; c < 3; ++c) {
      candidate[c] = truncated_mean(mean[c], taps);
      parallel_rows(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
          const double d = candidate[c](x, y) - context.reference->mean[c](x, y);
          error(x, y) += d * d / 3.0;
        }
      });
    }
    if (options.error_smoothing > 0.0) error = gaussian_blur(error, options.error_smoothing);
    parallel_rows(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        if (!(error(x, y) < least(x, y))) continue;
        least(x, y) = error(x, y);
        level(x, y) = s;
        for (std::size_t c = 0; c < 3; ++c)
          result.image[c](x, y) = candidate[c](x, y);
      }
    });
  }
  result.variance.reset();  // a choice made with the answer has no variance of its own
  result.level = std::move(level);
  result.notes.push_back("oracle_scale: chosen with the reference; a bound, not a method");
  return result;
}

Filter oracle_scale_filter() {
  using O = OracleScaleOptions;
  return make_value<FilterFunction, O>(
      {.name = "oracle_scale",
       .summary = "the Gaussian nearest to the reference at each pixel (an oracle)",
       .options =
           {
               number_option("error_smoothing", &O::error_smoothing, 0.0, 16.0,
                             "blur of the squared error that decides, pixels"),
           },
       .needs = [](const auto&) { return Needs{.reference = true}; },
       .memory = {220, 2e6},
       .cost = 0.29,
       .run = reconstruct_oracle_scale});
}

}  // namespace spool
