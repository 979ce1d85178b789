// Every second sample of what a selection took, as an image with its variance: the halves that
// dual-buffer filters compare [RousselleKnausZwicker12].
#pragma once

#include "lib/core/error.h"
#include "lib/core/option_table.h"
#include "lib/kernels/patch_filter.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

// Where the variance of a half's mean comes from. Half of a few samples often has variance 0 by
// chance, and distances are divided by it; pooling the window's cures that, but near bright pixels
// the window's is far too large.
enum class HalfVariance {
  kBoth,    // the piece's samples, of both halves; pooled where there is only one
  kAuto,    // of the half, as VarianceMode
  kRaw,     // the same
  kPooled,  // the same
};

struct SampleHalf {
  CountImage n;
  HalfImage image;  // exposed; empty pieces filled
};

// parity 0: the even samples, 1: the odd ones. Guards are counted on the whole, not on its halves.
// Error kData when the half has no sample.
Result<SampleHalf> sample_half(const PieceStatistics& statistics, const SamplePool& pool,
                               int parity, HalfVariance variance, double exposure);

template <class Options>
Option<Options> half_variance_option(HalfVariance Options::* member) {
  return choice_option<Options, HalfVariance>(
      "var_mode", member,
      {{"both", HalfVariance::kBoth},
       {"auto", HalfVariance::kAuto},
       {"raw", HalfVariance::kRaw},
       {"pooled", HalfVariance::kPooled}},
      "variance of a half's mean: of both halves' samples, or its own; auto pools below 4 of them");
}

}  // namespace spool
