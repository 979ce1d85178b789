// How large the filter of each piece is: the size stops growing where bias outweighs variance.
//
//   T_k = S_{k+1} - S_k + w_k (q_{k+1} - q_k)^2,  k = 0 .. K-1            [LiuZheng (9)]
//   size = 2^k for the first k with T_k > 0, else 2^K
//
// S_k: variance of the mean over R_k, (sum of v over R_k) / N^2, or the contrast V_k. q_k: mean
// over R_k, or the pyramid's f_k. w_k: see SizeFactorRule. E[(q_{k+1} - q_k)^2] of pure noise is
// S_k - S_{k+1}, so w is a significance test: stop where |dq| > sqrt(1 / w) standard deviations.
// The neighbours then vote (stop_votes.h). With `keep` (base_image.h) a piece that refused the base
// image has size 1, whatever T_0 says: that step came first.
// Slow twin: tests/reference/filter_size_reference.h.
#pragma once

#include <span>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/view.h"
#include "lib/filters/directional/options.h"
#include "lib/filters/directional/size_factor.h"

namespace spool {

// k of each piece, 0 .. K. Views: S.k, q.k, w.k, T.k, stop.k.
CountImage filter_size(const FilterSizeInput& input, const FilterSizeOptions& options, Views* views,
                       GuardCounts& guards);
// The same for several signals of the same pieces: T_k is the mean of theirs; counts, attenuation
// and levels are those of the first. Views S.k.i and q.k.i where there are several.
CountImage filter_size(std::span<const FilterSizeInput> inputs, const FilterSizeOptions& options,
                       Views* views, GuardCounts& guards);

// Variance of the mean over R_k of independent pieces.
Plane variance_over_region(const Plane& variance, int k);

}  // namespace spool
