// The metrics by name, each as a rule on sums over pixels; of this room alone.
#pragma once

#include <array>
#include <vector>

#include "lib/metrics/metric_description.h"

namespace spool {

inline constexpr int kDeciles = 10;

// Per-pixel terms whose block sums the linear metrics are ratios of.
enum Term : int {
  kCount,
  kSquared,                          // mean over channels of (I - R)^2 - b
  kSquaredOf,                        // + c
  kRawSquared = kSquaredOf + 3,      // without b
  kRelative,                         // mean over channels of ((I - R)^2 - b) / (D^2 + eps)
  kRelativeOf,                       // + c
  kRelativePlain = kRelativeOf + 3,  // kRelative in radiance units
  kAbsolute,
  kRelativeAbsolute,
  kSymmetric,
  kToneSquared,
  kEnergy,                                                 // sum over channels of I
  kReferenceEnergy,                                        // sum over channels of R
  kDecileEnergy,                                           // + decile
  kDecileReferenceEnergy = kDecileEnergy + kDeciles,       // + decile
  kDecileSquares = kDecileReferenceEnergy + kDeciles,      // + kSquareTerms decile + SquareTerm
  kDecileRelativeSquares = kDecileSquares + 6 * kDeciles,  // the same, weighted as in kRelative
  kTermCount = kDecileRelativeSquares + 6 * kDeciles
};
// What the squared error of an image times a factor g is made of: with gI - R = g (I - R) + (g - 1)
// R no large numbers cancel where g is near 1 or small, and with (I - R) + (g - 1) I where it is
// large. Means over channels.
enum SquareTerm : int {
  kErrorSquared,      // (I - R)^2
  kErrorReference,    // (I - R) R
  kReferenceSquared,  // R^2
  kErrorImage,        // (I - R) I
  kImageSquared,      // I^2
  kVariance,          // b
  kSquareTerms
};
using Terms = std::array<double, kTermCount>;
using PixelTerms = std::array<double, kDecileEnergy>;  // those before the deciles

enum class Rule {
  kRatio,
  kRootRatio,
  kDecibel,
  kTrimmed,
  kDropped,
  kQuantile,
  kMaximum,
  kEqualEnergy,   // numerator: the squares; the image times one factor
  kEqualDeciles,  // each decile times a factor of its own
  kPerceptual,    // by name, from perceptual_metrics
};

struct Metric {
  MetricDescription description;
  Rule rule = Rule::kRatio;
  int numerator = 0, denominator = kCount;  // Terms, of the ratio rules
};

const std::vector<Metric>& metric_list();

}  // namespace spool
