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

// Welford of every second sample of each piece. parity 0: the even samples, 1: the odd ones.
struct HalfSums {
  int parity = 0;
  CountImage n;
  RgbImage mean, m2;  // radiance; m2 empty where the half needs no variance of its own
};

HalfSums empty_half(int width, int height, int parity, HalfVariance variance);

// Takes what the half does not have yet of the first n samples of each piece.
void take_up_to(const CountImage& n, const SamplePool& pool, HalfSums& half);

// The image of a half that has all its samples of `statistics`. Guards are counted on the whole,
// not on its halves. Error kData when the half has no sample.
Result<SampleHalf> sample_half(const HalfSums& half, const PieceStatistics& statistics,
                               HalfVariance variance, double exposure);
// All of it at once.
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
