#include "lib/sampling/sampler.h"

#include <cmath>

#include "lib/sampling/adaptive_wavelet.h"
#include "lib/sampling/cross_bilateral.h"
#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/greedy_error.h"
#include "lib/sampling/mitchell.h"
#include "lib/sampling/multiscale/multiscale.h"
#include "lib/sampling/neyman.h"
#include "lib/sampling/nl_means.h"
#include "lib/sampling/sampler_entry.h"
#include "lib/sampling/uniform.h"

namespace spool {

const std::vector<SamplerEntry>& samplers() {
  static const std::vector<SamplerEntry> list = {
      sampler_entry<UniformOptions>("uniform", "the same number of samples in every piece",
                                    PrimaryText::kKnown, {{"", {}}}, uniform_option_table(),
                                    sample_uniform),
      sampler_entry<MultiscaleOptions>(
          "multiscale", "regions of many sizes, by contrast, lost detail and change",
          PrimaryText::kKnown, multiscale_presets(), multiscale_option_table(), sample_multiscale),
      sampler_entry<MitchellOptions>("mitchell", "pixels whose neighbourhood has a high contrast",
                                     PrimaryText::kByDescription, {{"", {}}},
                                     mitchell_option_table(), sample_mitchell),
      sampler_entry<AdaptiveWaveletOptions>(
          "adaptive_wavelet", "dyadic blocks by the variance and energy of their Haar coefficients",
          PrimaryText::kByDescription, {{"", {}}}, adaptive_wavelet_option_table(),
          sample_adaptive_wavelet),
      sampler_entry<GreedyErrorOptions>(
          "greedy_error", "where each pixel's best Gaussian still has the largest relative error",
          PrimaryText::kKnown, {{"", {}}}, greedy_error_option_table(), sample_greedy_error),
      sampler_entry<NlMeansSamplingOptions>(
          "nl_means", "where NL-means disagrees on two halves of the samples", PrimaryText::kKnown,
          {{"", {}}}, nl_means_sampling_option_table(), sample_nl_means),
      sampler_entry<CrossBilateralSamplingOptions>(
          "cross_bilateral", "where a filter guided by recorded features expects the largest risk",
          PrimaryText::kKnown, {{"", {}}}, cross_bilateral_sampling_option_table(),
          sample_cross_bilateral),
      sampler_entry<FilteredHalvesOptions>(
          "filtered_halves", "where the filter in the loop disagrees on two halves of the samples",
          PrimaryText::kKnown, {{"", {}}}, filtered_halves_option_table(), sample_filtered_halves),
      sampler_entry<NeymanOptions>("neyman", "oracle: by the deviation of everything recorded",
                                   PrimaryText::kKnown, {{"", {}}}, neyman_option_table(),
                                   sample_neyman),
  };
  return list;
}

Result<SamplerFunction> make_sampler(std::string_view name, std::string_view preset,
                                     const OptionValues& set) {
  std::vector<std::string> names;
  for (const SamplerEntry& entry : samplers()) {
    if (entry.name == name) return entry.make(preset, set);
    names.push_back(entry.name);
  }
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::kUsage, "unknown sampler '{}'{}", name,
              near.empty() ? std::string(": see spool list samplers")
                           : fmt::format(": did you mean '{}'?", near));
}

long long sample_budget(double samples_per_pixel, const RecordedSamples& recording) {
  SPOOL_CHECK_GE(samples_per_pixel, 0.0);
  return std::llround(samples_per_pixel * recording.width() * recording.height());
}

long long count_samples(const CountImage& n) {
  long long sum = 0;
  for (const std::int32_t count : n.pixels())
    sum += count;
  return sum;
}

long long count_saturated(const SamplePool& pool, const CountImage& n) {
  long long saturated = 0;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      saturated += n(x, y) >= pool.capacity(x, y);
  }
  return saturated;
}

void finish_log(SamplingLog& log, const SamplePool& pool, const CountImage& n) {
  log.saturated_pieces = count_saturated(pool, n);
  log.guards.add(Guard::kSaturatedPieces, static_cast<std::uint64_t>(log.saturated_pieces));
  log.guards.add(Guard::kUniformRemainder, static_cast<std::uint64_t>(log.uniform_remainder));
}

}  // namespace spool
