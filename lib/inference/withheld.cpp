#include "lib/inference/withheld.h"

#include <array>

namespace spool {

std::string_view withheld_name(Withheld withheld) {
  constexpr std::array<std::string_view, 3> kNames = {"", "few pixels", "reference noise"};
  return kNames[static_cast<std::size_t>(withheld)];
}

std::string_view withheld_remedy(Withheld withheld) {
  constexpr std::array<std::string_view, 3> kRemedies = {
      "", "record the scene three times or more", "record a longer reference, or compare mse"};
  return kRemedies[static_cast<std::size_t>(withheld)];
}

Withheld withheld_of(const ErrorStanding& standing) {
  if (standing.reference_noise > kMostReferenceNoise) return Withheld::kReferenceNoise;
  if (standing.own_spread) return Withheld::kNo;
  const double least = standing.halves ? kFewestPixels : kFewPixels;
  const bool few = standing.half_pixels * standing.independent_replicates < least;
  return few ? Withheld::kFewPixels : Withheld::kNo;
}

}  // namespace spool
