// Rules for samples that are not ordinary numbers, applied once at load and alike for every method.
//
// The default keeps every finite value: clamping negatives or fireflies biases the estimate. A
// rejected sample leaves its pixel's pool, which becomes shorter; nothing is invented in its place.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/option_table.h"

namespace spool {

using Rgb = std::array<float, 3>;

// A finite sample beyond this magnitude is taken for a renderer's accident, like an infinite one.
inline constexpr float kLargestRadiance = 1e15f;

// Share of non-finite samples above which loading is refused.
inline constexpr double kNonFiniteError = 1e-2;

enum class NonFiniteRule { kReject, kZero, kError };
enum class NegativeRule { kKeep, kClampToZero };

struct SanitiseRules {
  NonFiniteRule nonfinite = NonFiniteRule::kReject;
  NegativeRule negative = NegativeRule::kKeep;
  double firefly_limit = std::numeric_limits<double>::infinity();  // per channel, radiance units
  bool allow_many_rejected = false;  // also more than kNonFiniteError, and pixels left empty

  bool changes_values() const {
    return nonfinite == NonFiniteRule::kZero || negative == NegativeRule::kClampToZero ||
           firefly_limit < std::numeric_limits<double>::infinity();
  }
};

const OptionTable<SanitiseRules>& sanitise_option_table();

inline bool is_ordinary(const Rgb& value) {
  // NaN fails these comparisons, and raises no exception in them.
  for (const float v : value) {
    if (!std::islessequal(v, kLargestRadiance) || !std::isgreaterequal(v, -kLargestRadiance)) {
      return false;
    }
  }
  return true;
}

// The value that the rules hand on for an accepted sample.
Rgb sanitised(Rgb value, const SanitiseRules& rules);

struct SanitiseReport {
  std::uint64_t samples = 0;
  std::uint64_t nonfinite = 0;  // rejected or zeroed
  std::uint64_t negative = 0;   // samples with a negative channel, clamped or not
  std::uint64_t fireflies = 0;  // clamped
  int first_x = -1, first_y = -1, first_sample = -1;  // the first non-finite one, in y, x, s order
  std::uint64_t empty_pixels = 0;

  void add_nonfinite(int x, int y, int sample);  // one, or the first of several
  void add(const SanitiseReport& part);          // of other pixels
};

}  // namespace spool
