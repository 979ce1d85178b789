// Samples where a filter is unsure of itself, and no sample decides about its own half.
//
// The even samples of each piece are half A, the odd ones half B, with counts of their own. Both
// begin alike; in each round the filter is asked about the samples of A alone
// (filter_disagreement.h: on their even and their odd ones), and what it says decides where B
// samples; the same the other way round. The image is made of all n_A + n_B samples, whose mean is
// (mean_A + mean_B) / 2 (lib/statistics/joined_halves.h). Below six samples a piece A takes all of
// its share first and decides alone, and B begins with one sample: at four, B has one to place.
//
// With one round, the default, the counts of a half are a function of the other half's samples
// alone, so its mean is unbiased: no light is lost, which every sampler loses whose samples decide
// about themselves (docs/method.md). With several rounds a half still never decides about itself,
// but how many samples the other one had to decide by was its own doing, and light is lost again:
// 12 % of rare events without a filter, nothing measurable with twin_guides in the loop.
#pragma once

#include "lib/sampling/filter_disagreement.h"

namespace spool {

struct CrossHalvesOptions {
  // Share of the budget that is spent uniformly first, at least 2 samples of a half that decides.
  double start = 0.5;
  int rounds = 1;
  double blur = 2.0;  // sigma of the smoothing of e, pixels
  std::string filter = kDefaultLoopFilter;
};

// Errors: kUsage without a filter; whatever the filter returns.
Result<SamplingResult> sample_cross_halves(const SamplePool& pool, long long budget,
                                           const CrossHalvesOptions& options,
                                           const SamplingContext& context);

Sampler cross_halves_sampler();

}  // namespace spool
