// One selection of the samples that were taken of the two halves of a pool.
//
// n_A samples of the even half and n_B of the odd one make n = n_A + n_B samples of mean
//
//   mean = (mean_A + mean_B) / 2        v = s^2 (1 / n_A + 1 / n_B) / 4
//
// s^2: the sample variance of all n. Where the counts of a half never depend on its own samples,
// both means are unbiased and so is this one; the mean of all n samples is not, because the half
// that looked bright gave the other one more weight. Filters know count, mean and M2, so M2 is
// (n - 1) n v: it is that of all n samples where n_A = n_B, and larger elsewhere. Of a piece with
// samples of one half only these are the statistics.
#pragma once

#include "lib/statistics/selection.h"

namespace spool {

// Statistics as above with `halves` beside them, for a filter that reads pool_of_joined().
Selection join_halves(const SamplePool& pool, std::vector<Selection> halves);

// Which half sample i of a piece of pool_of_joined() is of, 0 <= i < even + odd.
int half_of_joined(int even, int odd, int i);

// Brings the statistics of the first even + odd samples of `joined`, a pool as pool_of_joined()
// gives, to the mean and M2 above: of samples that were changed after they were taken.
void weigh_halves_alike(PieceStatistics& all, const SamplePool& joined, const CountImage& even,
                        const CountImage& odd);

// The statistics of every second sample taken (parity 0: even), with the same analysis signal.
// `half_pool` is pool.half(parity).
PieceStatistics half_statistics(const PieceStatistics& statistics, const SamplePool& half_pool,
                                int parity);

// `pool` with the samples of both halves of `selection` first: what a filter may read of it.
SamplePool pool_of_joined(const SamplePool& pool, const Selection& selection);

// The shortest prefixes of the pool that hold every sample of a selection.
CountImage looked_at(const Selection& selection);
CountImage prefixes_over(const CountImage& even, const CountImage& odd);

}  // namespace spool
