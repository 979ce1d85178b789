// The options of the cross-bilateral filter by name.
#include "lib/kernels/cross_bilateral.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

constexpr double kLargestScale = 64.0;

// "0/1/2/4/8"
Option<CrossBilateralOptions> scales_option() {
  using O = CrossBilateralOptions;
  return {"scales", "S/S/..., 0 .. 64, ascending", "spatial scales to choose from, pixels",
          [](O& options, std::string_view text) -> Result<void> {
            std::vector<double> scales;
            while (true) {
              const std::size_t slash = text.find('/');
              SPOOL_ASSIGN(const double scale,
                           parse_number("scales", text.substr(0, slash), 0.0, kLargestScale));
              if (!scales.empty() && !(scale > scales.back())) {
                return fail(ErrorCode::kUsage, "option scales: {} does not ascend", scale);
              }
              scales.push_back(scale);
              if (slash == std::string_view::npos) break;
              text.remove_prefix(slash + 1);
            }
            options.scales = std::move(scales);
            return {};
          },
          [](const O& options) {
            std::string text;
            for (const double scale : options.scales)
              text += (text.empty() ? "" : "/") + format_number(scale);
            return text;
          }};
}

}  // namespace

OptionTable<CrossBilateralOptions> cross_bilateral_option_table() {
  using O = CrossBilateralOptions;
  return {
      scales_option(),
      number_option<O>("risk_scale", &O::risk_scale, 0.25, kLargestScale,
                       "spatial scale of the smoothing of the risk, pixels"),
      number_option<O>("sigma_normal", &O::sigma_normal, 1e-3, 1e3, "tolerance for normals"),
      number_option<O>("sigma_albedo", &O::sigma_albedo, 1e-3, 1e3, "tolerance for albedo"),
      number_option<O>("sigma_depth", &O::sigma_depth, 1e-3, 1e3,
                       "tolerance for depth, in units of the largest"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the normalised luminance"),
  };
}

}  // namespace spool
