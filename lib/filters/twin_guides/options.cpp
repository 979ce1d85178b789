#include "lib/filters/twin_guides/options.h"

#include <algorithm>
#include <cmath>

#include "lib/kernels/scene_luminance.h"

namespace spool {
namespace {

// Chosen on pictures of 256 and 512 pixels: half way between them, in octaves.
constexpr int kLargestSideOfThreeScales = 362;

}  // namespace

TwinGuidesOptions heavy_tailed_twin_guides_options() {
  TwinGuidesOptions options;
  options.heavy = 0.0;
  return options;
}

OptionTable<TwinGuidesOptions> twin_guides_option_table() {
  using O = TwinGuidesOptions;
  return {
      integer_or_word_option("scales", &O::scales, "auto", 1, 5,
                             "taps of the window 1, 2, 4, ... pixels apart; auto: 3, and 4 where "
                             "the picture's smaller side has more than 362"),
      integer_option("radius", &O::radius, 1, 24, "of the window, pixels"),
      number_option("sigma", &O::sigma, 0.1, 100.0, "of the window's Gaussian, pixels"),
      number_option("guide_sigma", &O::guide_sigma, 0.1, 4.0,
                    "blur of the finer guides, pixels; the coarser have twice that"),
      number_option("stretch", &O::stretch, 0.0, 4.0,
                    "of the coarser guides along the structure of the picture; 0: none"),
      number_option("slack", &O::slack, 0.0, 100.0, "factor on the noise of the guides"),
      number_option("small_slack", &O::small_slack, 0.0, 100.0, "the same below small_noise"),
      number_option("small_noise", &O::small_noise, 0.0, 10.0,
                    "standard deviation of the logarithms of samples; 0: slack everywhere"),
      number_option("detail_slack", &O::detail_slack, 0.0, 100.0,
                    "factor on the noise of a scale's detail"),
      number_option("tau", &O::tau, 1e-3, 10.0,
                    "difference of the guides that counts, without noise"),
      number_option("feature_gain", &O::feature_gain, 0.0, 100.0,
                    "weight of the distance of features"),
      number_option("cut", &O::cut, 0.1, 50.0, "distance at which a weight is 0"),
      number_option("ridge", &O::ridge, 1e-3, 1e3, "on the slopes of the fit"),
      number_option("limit", &O::limit, 1.0, 1e12,
                    "of a neighbour's luminance, times the window's"),
      number_option("clamp_sigma", &O::clamp_sigma, 0.1, 64.0,
                    "neighbourhood by which single samples are clamped, pixels"),
      number_option("heavy", &O::heavy, 0.0, 1000.0,
                    "share of the light that independent samples lose alike, of what is kept, from "
                    "which tails are heavy; 0: any share"),
      number_option("opening", &O::opening, 0.0, 1000.0,
                    "of the clamp where tails are heavy; 0: none, and no noise is pooled"),
      integer_option("noise_pool", &O::noise_pool, 0, 64,
                     "largest radius from which a variance is pooled there, pixels; 0: neighbours "
                     "alone"),
      number_option("agreement", &O::agreement, 0.0, 64.0,
                    "reach over which clamped light that samples agree on returns, pixels"),
  };
}

int scale_count(const TwinGuidesOptions& options, int width, int height) {
  return options.scales.value_or(std::min(width, height) > kLargestSideOfThreeScales ? 4 : 3);
}

RadianceScale radiance_scale(const PieceStatistics& statistics, GuardCounts& guards) {
  const double luminance = scene_luminance(statistics, guards);
  const double unit = std::ldexp(1.0, -std::ilogb(luminance));
  return {unit, luminance * unit};
}

}  // namespace spool
