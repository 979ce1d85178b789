#include "lib/filters/wavelet_shrinkage.h"

#include <algorithm>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

double shrunk(double w, double threshold, Shrink rule) {
  if (rule == Shrink::kHard) return std::abs(w) > threshold ? w : 0.0;
  return std::copysign(std::max(0.0, std::abs(w) - threshold), w);
}

void shrink_band(Plane& coefficients, const Plane& variance, const Rectangle& band,
                 const WaveletShrinkageOptions& options) {
  double signal = 0.0;  // sigma_x of the band
  if (options.shrink == Shrink::kBayes) {
    const auto width = static_cast<std::size_t>(band.width());
    const auto excess = [&](std::size_t i) {
      const int x = band.x0 + static_cast<int>(i % width),
                y = band.y0 + static_cast<int>(i / width);
      return coefficients(x, y) * coefficients(x, y) - variance(x, y);
    };
    const auto n = static_cast<std::size_t>(band.area());
    signal = std::sqrt(std::max(0.0, pairwise_sum(n, excess) / static_cast<double>(n)));
  }
  parallel_rows(band.y0, band.y1, [&](int y) {
    for (int x = band.x0; x < band.x1; ++x) {
      const double v = variance(x, y);
      if (!(v > 0.0) || options.lambda == 0.0) continue;
      double& w = coefficients(x, y);
      if (options.shrink != Shrink::kBayes) {
        w = shrunk(w, options.lambda * std::sqrt(v), options.shrink);
      } else {
        w = signal > 0.0 ? shrunk(w, options.lambda * v / signal, Shrink::kSoft) : 0.0;
      }
    }
  });
}

}  // namespace

OptionTable<WaveletShrinkageOptions> wavelet_shrinkage_option_table() {
  using O = WaveletShrinkageOptions;
  return {
      choice_option<O, TransformWavelet>(
          "awr_wavelet", &O::wavelet,
          {{"cdf97", TransformWavelet::kCdf97}, {"haar", TransformWavelet::kHaar}},
          "wavelet of the transform"),
      integer_option<O>("awr_levels", &O::levels, 1, 8, "levels of the transform"),
      choice_option<O, Shrink>(
          "awr_shrink", &O::shrink,
          {{"soft", Shrink::kSoft}, {"hard", Shrink::kHard}, {"bayes", Shrink::kBayes}},
          "rule that makes coefficients smaller"),
      number_option<O>("lambda", &O::lambda, 0.0, 100.0,
                       "threshold in standard deviations of a coefficient; 0 changes nothing"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6,
                       "mean luminance that the floor of the variance is written for"),
  };
}

Result<Reconstruction> reconstruct_wavelet_shrinkage(const Selection& selection, const SamplePool&,
                                                     const WaveletShrinkageOptions& options,
                                                     const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  const int q = statistics.pieces_per_side;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, options.key, true, result.guards);
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(statistics, {options.var_mode, options.nu0, options.key}, exposure,
                               result.guards));
  const RgbImage mean = average_pieces(std::move(pieces.mean), q);
  const RgbImage variance = average_piece_variance(std::move(pieces.variance), q);
  result.image = make_rgb(mean[0].width(), mean[0].height());
  for (std::size_t c = 0; c < 3; ++c) {
    Plane w = padded_for_transform(mean[c], options.levels);
    Plane v = padded_for_transform(variance[c], options.levels);
    forward_transform(w, options.wavelet, options.levels, TransformOf::kValues);
    forward_transform(v, options.wavelet, options.levels, TransformOf::kVariances);
    for (int l = 0; l < options.levels; ++l) {
      const int width = w.width() >> l, height = w.height() >> l;
      shrink_band(w, v, {width / 2, 0, width, height / 2}, options);
      shrink_band(w, v, {0, height / 2, width / 2, height}, options);
      shrink_band(w, v, {width / 2, height / 2, width, height}, options);
    }
    inverse_transform(w, options.wavelet, options.levels);
    parallel_rows(0, mean[c].height(), [&](int y) {
      std::copy_n(w.row(y).data(), mean[c].width(), result.image[c].row(y).data());
    });
  }
  return result;
}

Filter wavelet_shrinkage_filter() {
  return make_value<FilterFunction, WaveletShrinkageOptions>(
      {.name = "wavelet_shrinkage",
       .summary = "wavelet coefficients reduced by an estimate of their error",
       .source = Source::kDescriptions,
       .options = wavelet_shrinkage_option_table(),
       .memory = {180, 2e6},
       .run = reconstruct_wavelet_shrinkage});
}

}  // namespace spool
