#include "lib/metrics/metric_options.h"

#include <limits>

#include "lib/core/nearest_name.h"
#include "lib/metrics/metric_description.h"

namespace spool {

Result<std::vector<bool>> metrics_named(const std::vector<std::string>& names) {
  std::vector<bool> wanted;
  for (const std::string& name : names) {
    const int index = metric_index(name);
    if (index < 0) {
      return fail(ErrorCode::kUsage, "{}",
                  unknown_name("metric", name, names_of(metrics()), ": see spool list metrics"));
    }
    wanted.resize(metrics().size(), false);
    wanted[static_cast<std::size_t>(index)] = true;
  }
  return wanted;
}

const OptionTable<MetricOptions>& metric_option_table() {
  constexpr double kLargest = std::numeric_limits<double>::max();
  static const OptionTable<MetricOptions> table = {
      number_option("rel_eps", &MetricOptions::rel_eps, 1e-12, kLargest,
                    "added to the squared reference in relmse"),
      choice_option<MetricOptions, RelativeScale>(
          "rel_scale", &MetricOptions::rel_scale,
          {{"mean", RelativeScale::kMean}, {"none", RelativeScale::kNone}},
          "relative metrics divide both images by the reference's mean luminance, or not"),
      choice_option<MetricOptions, RelativeDenominator>(
          "rel_denominator", &MetricOptions::rel_denominator,
          {{"per_channel", RelativeDenominator::kPerChannel},
           {"luminance", RelativeDenominator::kLuminance}},
          "relmse divides each channel by itself, or all by the luminance"),
      number_option("trim", &MetricOptions::trim, 0.0, 0.5,
                    "share of pixels that relmse_trimmed leaves out"),
      choice_option<MetricOptions, Perceptual>(
          "perceptual", &MetricOptions::perceptual,
          {{"none", Perceptual::kNone}, {"fast", Perceptual::kFast}, {"all", Perceptual::kAll}},
          "SSIM, MS-SSIM and FLIP: none of them, all but flip_hdr, or all"),
  };
  return table;
}

}  // namespace spool
