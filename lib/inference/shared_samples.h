// How much the replicates of one recording have in common: the samples that they share.
//
// Replicates of a recording with N samples per pixel that take n of a pixel overlap there once they
// are more than N / n. Errors of images that share samples are correlated. Noise that every sample
// has a part in correlates as the square of the share, rare events as the share itself [the page
// docs/coverage.md measures both]; the share is taken, which is the larger.
#pragma once

#include <span>
#include <utility>

namespace spool {

enum class Taking {
  kOwnOrder,   // every replicate shuffles the samples of a pixel anew
  kOneAround,  // one shuffled order around a ring; replicate r starts at radical_inverse(r)
};

// Share of the samples of a replicate that another replicate took too: mean over pairs of
// replicates, and over the pixels that took any: what varies from recording to recording are the
// errors of pixels, which an adaptive sampler makes more alike than the samples it spends on them.
// `counts`: samples taken and the number of pixels that took so many; all replicates are taken to
// be alike in it.
// `recorded`: samples per pixel of the recording. 0 for one replicate.
double shared_share(std::span<const std::pair<int, long long>> counts, double recorded,
                    int replicates, Taking taking);

// The same as a mean over all pairs of replicates of several recordings, which share nothing with
// each other; `replicates` of each.
double over_recordings(double shared, int replicates, int recordings);

}  // namespace spool
