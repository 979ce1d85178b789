#include "lib/metrics/metric_list.h"

#include <string>
#include <utility>

#include <fmt/core.h>

namespace spool {
namespace {

// The energy of parts of the image, and errors once it is made right.
void add_energy_metrics(std::vector<Metric>& list) {
  for (int d = 0; d < kDeciles; ++d) {
    list.push_back({{fmt::format("energy_ratio_d{}", d + 1),
                     fmt::format("energy ratio of decile {} of the reference's luminance{}", d + 1,
                                 d == 0 ? " (the darkest)" : ""),
                     Better::kOne},
                    Rule::kRatio,
                    kDecileEnergy + d,
                    kDecileReferenceEnergy + d});
  }
  const auto equal = [&](std::string name, std::string meaning, Rule rule, int squares) {
    list.push_back({{std::move(name), std::move(meaning)}, rule, squares});
  };
  equal("mse_equal_energy", "mse of the image times one factor that makes energy_ratio 1",
        Rule::kEqualEnergy, kDecileSquares);
  equal("relmse_equal_energy", "relmse of the image times that factor", Rule::kEqualEnergy,
        kDecileRelativeSquares);
  equal("mse_equal_deciles",
        "mse of the image with the energy of every decile made right by a factor",
        Rule::kEqualDeciles, kDecileSquares);
  equal("relmse_equal_deciles", "relmse of that image", Rule::kEqualDeciles,
        kDecileRelativeSquares);
}

std::vector<Metric> make_list() {
  std::vector<Metric> list = {
      {{"mse", "mean squared error over pixels and channels, debiased"}, Rule::kRatio, kSquared},
      {{"mse_r", "mean squared error of red, debiased"}, Rule::kRatio, kSquaredOf},
      {{"mse_g", "mean squared error of green, debiased"}, Rule::kRatio, kSquaredOf + 1},
      {{"mse_b", "mean squared error of blue, debiased"}, Rule::kRatio, kSquaredOf + 2},
      {{"rmse", "root of the mean squared error, not debiased"}, Rule::kRootRatio, kRawSquared},
      {{"relmse",
        "mean of (squared error, debiased) / (reference^2 + rel_eps), both images first divided by "
        "the reference's mean luminance (option rel_scale); rel_eps is 0.01 and keeps black pixels "
        "from deciding"},
       Rule::kRatio,
       kRelative},
      {{"relmse_r", "relmse of red"}, Rule::kRatio, kRelativeOf},
      {{"relmse_g", "relmse of green"}, Rule::kRatio, kRelativeOf + 1},
      {{"relmse_b", "relmse of blue"}, Rule::kRatio, kRelativeOf + 2},
      {{"relmse_trimmed", "relmse without the largest 0.1 % of the pixels (option trim)"},
       Rule::kTrimmed},
      {{"relmse_dropped", "what those pixels add to relmse"}, Rule::kDropped},
      {{"relmse_plain",
        "relmse in radiance units, as other programs have it: neither image is divided by the "
        "mean luminance first"},
       Rule::kRatio,
       kRelativePlain},
      {{"mae", "mean absolute error over pixels and channels"}, Rule::kRatio, kAbsolute},
      {{"relmae", "mean of absolute error / (|reference| + 0.01)"},
       Rule::kRatio,
       kRelativeAbsolute},
      {{"smape", "mean of absolute error / (|image| + |reference| + 0.01), 0 .. 1"},
       Rule::kRatio,
       kSymmetric},
      {{"se_p999", "99.9 % quantile of the pixels' squared error, not debiased"}, Rule::kQuantile},
      {{"se_max", "largest squared error of a pixel, not debiased"}, Rule::kMaximum},
      {{"psnr_tm", "peak signal-to-noise ratio of the tone-mapped images, dB", Better::kHigher},
       Rule::kDecibel,
       kToneSquared},
      {{"ssim", "structural similarity of the tone-mapped luma, at most 1", Better::kHigher},
       Rule::kPerceptual},
      {{"ms_ssim", "the same over up to five scales", Better::kHigher}, Rule::kPerceptual},
      {{"flip_ldr", "mean FLIP of the tone-mapped images, 0 .. 1"}, Rule::kPerceptual},
      {{"flip_hdr",
        "mean over pixels of the worst FLIP over at most 16 exposures, 0 .. 1 (option "
        "perceptual=all)"},
       Rule::kPerceptual},
      {{"energy_ratio", "sum of the image / sum of the reference", Better::kOne},
       Rule::kRatio,
       kEnergy,
       kReferenceEnergy},
  };
  add_energy_metrics(list);
  return list;
}

}  // namespace

const std::vector<Metric>& metric_list() {
  static const std::vector<Metric> all = make_list();
  return all;
}

const std::vector<MetricDescription>& metrics() {
  static const std::vector<MetricDescription> descriptions = [] {
    std::vector<MetricDescription> all;
    for (const Metric& metric : metric_list())
      all.push_back(metric.description);
    return all;
  }();
  return descriptions;
}

int metric_index(std::string_view name) {
  const std::vector<MetricDescription>& all = metrics();
  for (std::size_t m = 0; m < all.size(); ++m) {
    if (all[m].name == name) return static_cast<int>(m);
  }
  return -1;
}

std::string_view better_name(Better better) {
  return better == Better::kLower ? "lower" : (better == Better::kHigher ? "higher" : "near 1");
}

Better better_of(std::string_view quantity) {
  const int metric = metric_index(quantity);
  return metric < 0 ? Better::kLower : metrics()[static_cast<std::size_t>(metric)].better;
}

}  // namespace spool
