// Oracle: samples in proportion to the standard deviation of each piece's whole recorded pool
// [Neyman34], in the best whole numbers. It knows what no sampler can know.
//
//   v = mean_c w_c s_c^2     s_c: deviation of channel c over everything recorded
//   each next sample goes where it takes most off the sum of v / n: v / (n (n + 1))
//   w_c = 1 with minimise=mse; u^2 / (u^2 D_c^2 + 0.01) with minimise=relmse, as that metric weighs
//         (D the reference, or the mean of everything recorded; u = 1 / its mean luminance)
//
// With counts that are fixed in advance and no filter no other counts have a smaller expectation of
// that error: with minimise=mse the oracle bounds no relative errors, and the reverse. A
// sampler that decides by its own samples can still show a smaller error: it stops where it has
// missed bright samples, which is bias and not variance, so the bound does not hold for it (see the
// columns *_fresh and *_bias2). Slow twin: tests/reference/neyman_reference.h.
#pragma once

#include "lib/sampling/sampler.h"

namespace spool {

enum class NeymanTarget { kSquaredError, kRelativeError };

struct NeymanOptions {
  NeymanTarget minimise = NeymanTarget::kSquaredError;
  int init_spp = 1;  // every piece, whatever its deviation
};

// The deviations count the held-out samples too.
Result<SamplingResult> sample_neyman(const SamplePool& pool, long long budget,
                                     const NeymanOptions& options, const SamplingContext& context);

Sampler neyman_sampler();

}  // namespace spool
