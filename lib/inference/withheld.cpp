#include "lib/inference/withheld.h"

namespace spool {

std::string_view withheld_name(Withheld withheld) {
  switch (withheld) {
    case Withheld::kNo:
      return "";
    case Withheld::kFewPixels:
      return "few pixels";
    case Withheld::kReferenceNoise:
      return "reference noise";
  }
  return "";
}

std::string_view withheld_remedy(Withheld withheld) {
  switch (withheld) {
    case Withheld::kNo:
      return "";
    case Withheld::kFewPixels:
      return "record the scene three times or more";
    case Withheld::kReferenceNoise:
      return "record a longer reference, or compare mse";
  }
  return "";
}

Withheld withheld_of(const ErrorStanding& standing) {
  if (standing.reference_noise > kMostReferenceNoise) return Withheld::kReferenceNoise;
  if (standing.own_spread) return Withheld::kNo;
  const double least = standing.halves ? kFewestPixels : kFewPixels;
  const bool few = standing.half_pixels * standing.independent_replicates < least;
  return few ? Withheld::kFewPixels : Withheld::kNo;
}

}  // namespace spool
