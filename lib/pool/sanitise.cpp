#include "lib/pool/sanitise.h"

#include <algorithm>
#include <tuple>

namespace spool {

const OptionTable<SanitiseRules>& sanitise_option_table() {
  static const OptionTable<SanitiseRules> table = {
      choice_option<SanitiseRules, NonFiniteRule>(
          "nonfinite", &SanitiseRules::nonfinite,
          {{"reject", NonFiniteRule::kReject},
           {"zero", NonFiniteRule::kZero},
           {"error", NonFiniteRule::kError}},
          "what becomes of NaN, infinite or > 1e15 samples"),
      choice_option<SanitiseRules, NegativeRule>(
          "negative", &SanitiseRules::negative,
          {{"keep", NegativeRule::kKeep}, {"clamp0", NegativeRule::kClampToZero}},
          "what becomes of negative samples; clamping biases the estimate"),
      number_option("firefly_limit", &SanitiseRules::firefly_limit, 0.0,
                    std::numeric_limits<double>::infinity(),
                    "largest value of a channel; inf keeps every sample, less biases the estimate"),
      switch_option(
          "allow_many_rejected", &SanitiseRules::allow_many_rejected,
          "go on when more than 1 % of the samples or all samples of a pixel are rejected"),
  };
  return table;
}

Rgb sanitised(Rgb value, const SanitiseRules& rules) {
  if (rules.nonfinite == NonFiniteRule::kZero && !is_ordinary(value)) return {0.0f, 0.0f, 0.0f};
  if (rules.negative == NegativeRule::kClampToZero) {
    for (float& v : value)
      v = std::max(v, 0.0f);
  }
  if (rules.firefly_limit < std::numeric_limits<double>::infinity()) {
    const auto limit = static_cast<float>(rules.firefly_limit);
    for (float& v : value)
      v = std::min(v, limit);
  }
  return value;
}

void SanitiseReport::add_nonfinite(int x, int y, int sample) {
  ++nonfinite;
  if (first_sample >= 0 && std::tie(first_y, first_x, first_sample) <= std::tie(y, x, sample))
    return;
  first_x = x, first_y = y, first_sample = sample;
}

void SanitiseReport::add(const SanitiseReport& part) {
  if (part.nonfinite > 0) {
    add_nonfinite(part.first_x, part.first_y, part.first_sample);
    nonfinite += part.nonfinite - 1;
  }
  samples += part.samples;
  negative += part.negative;
  fireflies += part.fireflies;
  empty_pixels += part.empty_pixels;
}

}  // namespace spool
