// How much the replicates of one recording have in common: the samples that they share, and how
// alike that makes their errors.
//
// Replicates of a recording with N samples per piece of a pixel that take n of it overlap there
// once they are more than N / n. Squared errors of two images that share the part c of the samples
// of a piece correlate by c^2 where its noise has many small parts, by c where it is one rare event
// that both have or have not. Both are there: the variance of the square of a mean of n samples
// with variance s^2 and fourth cumulant k is 2 s^4 / n^2 + k / n^3, and its two terms correlate by
// c^2 and by c. So the excess kurtosis k / s^4 of the samples (lib/experiment/sample_kurtosis.h)
// says how much of either there is. docs/coverage.md counts what the intervals made of it hold.
#pragma once

#include <utility>
#include <vector>

namespace spool {

enum class Taking {
  kOwnOrder,   // every replicate shuffles the samples of a piece anew
  kOneAround,  // one shuffled order around a ring; replicate r starts at radical_inverse(r)
};

// Samples taken of a piece, and how many pieces took so many; ascending.
using TakenCounts = std::vector<std::pair<int, long long>>;

// What a method's replicates took of one recording; all replicates are taken to be alike in it.
struct TakenSamples {
  TakenCounts counts;   // empty: not known
  double recorded = 0;  // samples of a piece in the recording
  double rare = 1;      // share of the variance of squared errors that is rare events, 0 .. 1
};

// Of means of `samples` samples with this excess kurtosis: (k / n) / (2 + k / n), from 0 for normal
// samples (and for lighter tails) to 1. 1 where the kurtosis is not known (NaN), which is the
// careful side.
double rare_share(double kurtosis, double samples);

struct Shared {
  double samples = 0;      // share of a replicate's samples that another took too
  double correlation = 0;  // of the squared errors of two replicates
};

// The pairs of a number of replicates, by how far apart they start on the ring: of a thousand there
// are half a million, and 1024 distances.
struct ReplicatePairs {
  int replicates = 0;
  std::vector<long long> apart;  // [distance in steps; as many steps as entries around the ring]
};
ReplicatePairs pairs_of(int replicates);

// Means over pairs of replicates, and over the pieces that took any: what varies from recording to
// recording are the errors of pixels, which an adaptive sampler makes more alike than the samples
// it spends on them. Nothing for one replicate.
Shared shared_by_replicates(const TakenSamples& taken, const ReplicatePairs& pairs, Taking taking);

// The same as a mean over all pairs of replicates of several recordings, which share nothing with
// each other; `replicates` of each.
double over_recordings(double shared, int replicates, int recordings);

// Correlation of the squared errors of two methods in one replicate if their filters were the same:
// they begin with the same samples of every piece, and the method that takes more of a piece goes
// on. Pieces are matched in the order of their counts, as methods that agree on where samples are
// wanted would have it. 1 where counts are not known.
double shared_by_methods(const TakenSamples& a, const TakenSamples& b);

// Correlation, between replicates, of the difference of two methods. What both methods share with
// another replicate cancels in it: with errors of equal variance, `correlation` of each between
// replicates, and the correlation `measured` of the two in one replicate of which samples explain
// at most `same`, it is correlation (1 - measured / same) / (1 - measured). The whole `correlation`
// for one sampler with two filters (same = 1), and where the errors have nothing in common.
double shared_by_differences(double correlation, double same, double measured);

}  // namespace spool
