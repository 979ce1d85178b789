// When an error is given without interval and verdict: it stands on too little for either to hold
// (docs/coverage.md has what was measured).
#pragma once

#include <limits>
#include <string_view>

namespace spool {

enum class Withheld {
  kNo,
  kFewPixels,      // so few pixels carry the error that another recording may have others
  kReferenceNoise  // the reference is too noisy for a metric that divides by it
};
std::string_view withheld_name(Withheld withheld);    // "": kNo
std::string_view withheld_remedy(Withheld withheld);  // what gives a verdict; "": kNo

// Half of the error lies in fewer pixels, those of independent replicates counted together. Where
// the spread between recordings is not measured, their number alone varies by a quarter and more;
// where halves measure it, intervals held as often as any down to the second bound, and fewer
// pixels were hardly met.
inline constexpr double kFewPixels = 20.0, kFewestPixels = 3.0;
// The reference's relative variance (mean of variance / (reference^2 + eps)) is above this: the
// ratio of two relMSEs then differs from that by an exact reference by a third and more, and the
// order of methods may turn round.
inline constexpr double kMostReferenceNoise = 0.01;

// NaN: not known, and nothing is withheld for it.
struct ErrorStanding {
  double half_pixels = std::numeric_limits<double>::quiet_NaN();  // of one replicate
  double independent_replicates = 1.0;  // that the mean is worth: n / (1 + (n - 1) correlation)
  double reference_noise = std::numeric_limits<double>::quiet_NaN();
  bool halves = false;      // the spread is that of halves of the recording (half_spread.h)
  bool own_spread = false;  // or that of kOwnSpread recordings: then the pixels may be few
};
Withheld withheld_of(const ErrorStanding& standing);

}  // namespace spool
