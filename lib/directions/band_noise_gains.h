// What white noise leaves in each directional band of a detail image.
#pragma once

#include <vector>

#include "lib/directions/directional_filter_bank.h"
#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {

// g_i: sum of squares of the impulse response of "band i of d_{level-1}", by pushing a delta
// through the pyramid and the bank (with the dilation of `bank`). phase00 is not shift-invariant:
// the mean over deltas on its four phases. `prefilter` is what the image passed, rows and columns,
// before it became f_0. By summing the squares of the frequency responses, a few milliseconds for
// the largest level; for phase00 by pushing the deltas through, that of a bank on a few hundred
// pixels square.
std::vector<double> band_noise_gains(const PyramidOptions& pyramid, const BankOptions& bank,
                                     int level, const Taps& prefilter = {0, {1.0}});

}  // namespace spool
