// How heavy the tails of a recording's samples are, in one number.
#pragma once

#include "lib/pool/recorded_samples.h"

namespace spool {

// Excess kurtosis of the samples about the mean of their pixel: the sum over pixels of the fourth
// cumulant over that of the squared variance, each pixel weighted as in a relative squared error. 0
// for normal noise, negative for lighter tails; a firefly in a hundred thousand samples makes it
// large. Of the mean of a sample's three channels. Unbiased estimates of both sums [Fisher30], from
// at most 4096 pixels spread over the picture. NaN where no pixel has four samples or none varies.
// In any unit of radiance the same.
double sample_kurtosis(const RecordedSamples& recording);

}  // namespace spool
