// Options of the metrics.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"
#include "lib/metrics/bootstrap.h"
#include "lib/metrics/perceptual_metrics.h"

namespace spool {

enum class RelativeScale { kMean, kNone };
enum class RelativeDenominator { kPerChannel, kLuminance };

struct MetricOptions {
  double rel_eps = 0.01;  // added to the squared denominator of relMSE, after `rel_scale`
  // kMean: estimate and reference are divided by the mean luminance of the reference before any
  // relative metric; kNone: radiance units, to compare with published figures.
  RelativeScale rel_scale = RelativeScale::kMean;
  RelativeDenominator rel_denominator = RelativeDenominator::kPerChannel;
  double trim = 0.001;  // share of pixels that relmse_trimmed drops, the largest first
  Perceptual perceptual = Perceptual::kFast;
  BootstrapOptions bootstrap;
  std::vector<bool> wanted;  // [metric], as metrics(); the others are NaN. Empty: all
  bool support = true;       // also what mse and relmse stand on (ErrorSupport)
};

// MetricOptions::wanted of these names, of none: all. kUsage for one that is no metric's.
Result<std::vector<bool>> metrics_named(const std::vector<std::string>& names);

const OptionTable<MetricOptions>& metric_option_table();

}  // namespace spool
