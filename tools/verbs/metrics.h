// `spool metrics IMAGE REFERENCE`: every metric of one image against another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/image_io/layer_choice.h"
#include "lib/metrics/error_metrics.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct MetricsOptions {
  std::filesystem::path image, reference;
  std::filesystem::path variance;     // of the reference's mean, R, G, B; empty: taken as exact
  std::vector<std::string> masks;     // "NAME=FILE": energy ratio where the mask is above 0.5
  std::vector<std::string> settings;  // "OPTION=VALUE" of the metrics
  std::filesystem::path error_map;    // squared error per pixel as EXR; empty: none
  LayerChoice layer;                  // of the image
  LayerChoice reference_layer = {"", "", "--reference-layer ", "--reference-part "};
};

// "OPTION=VALUE" of all metrics, the perceptual ones included.
Result<MetricOptions> metric_settings(const std::vector<std::string>& settings);

// kData when the image `name` and the reference differ in size.
Result<void> check_same_size(const RgbImage& image, const RgbImage& reference,
                             const std::string& name);

// kData when pixels of the image `name` or of `reference` are not finite and had to be left out.
Result<void> check_finite(const MetricTable& table, const std::string& name,
                          const std::string& reference);

Result<void> validate(const MetricsOptions& options);
Result<void> run_metrics(const MetricsOptions& options, const CommonOptions& common);

}  // namespace spool::tools
