// Gives back what the clamp took where independent samples agree on it: a single bright sample is a
// firefly, but bright samples that come again all over a neighbourhood are light on rare paths.
//
//   r_k   = luminance that the clamp took from the samples of group k = position mod m, mean;
//           m = min(4, smallest n_p > 0)
//   s = sigma/4:  light_s = min over k of G_s * r_k;   then r_k *= 1 - light_s / (G_s * r_k)
//   s = sigma:    light_s = mean over k of G_s * r_k without the largest
//   out'  = out (1 + sum over s of light_s / (G_s * w)),   w = max(luminance(out), 0) + 0.1 L
//
// Every group has seen other samples, so what one of them lacks is not believed, and a single
// sample changes nothing. Light returns to its neighbourhood, not to its pixel, in the shape of the
// picture: what agrees within the short reach stays there (a lamp out of focus would shine
// on all around it), and only the rest goes far. The least of four means is below the mean, by half
// where few samples carry the light; far away the mean of three is used, which is less biased and
// does not show. Nothing happens with fewer than two groups. Why these reaches: docs/decisions.md,
// 0125, 0170. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

struct AgreedLight {
  Image<float> near, far;  // light_s of s = sigma/4 and of s = sigma; empty: nothing comes back
};

// `taken`: SampleMoments::clamped_light. sigma in pieces; 0: nothing is given back.
AgreedLight agreed_light(std::vector<Image<float>> taken, double sigma);

FloatRgb return_agreed_light(FloatRgb out, const AgreedLight& agreed, double sigma,
                             const RadianceScale& scale);

}  // namespace spool
