// Every second sample of what a selection took, as an image with its variance: the halves that
// dual-buffer filters compare [RousselleKnausZwicker12].
#pragma once

#include "lib/core/error.h"
#include "lib/kernels/patch_filter.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

struct SampleHalf {
  CountImage n;
  HalfImage image;  // exposed; empty pieces filled
};

// parity 0: the even samples, 1: the odd ones. Guards are counted on the whole, not on its halves.
// Error kData when the half has no sample.
Result<SampleHalf> sample_half(const PieceStatistics& statistics, const SamplePool& pool,
                               int parity, const VarianceOptions& options, double exposure);

}  // namespace spool
