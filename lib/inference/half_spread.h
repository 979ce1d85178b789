// How much an error varies from one recording of a scene to the next, measured on one recording.
//
// The samples of every pixel are split into two halves, and a method makes an image of each. The
// two images have no sample in common, whatever the sampler does with them, so half the squared
// difference of their errors has the variance between recordings as its expectation. One
// difference of two numbers would say little; but an error is a mean over pixels, and parts of the
// image that are farther apart than a filter reaches vary independently. So the difference is kept
// by cell of the image, and its square is summed over windows of 2 x 2 cells, each cell in four of
// them with weight 1/4: neighbours may be alike (Bartlett's weights [NeweyWest87]). How few cells
// carry the sum says with how many degrees of freedom it is known.
#pragma once

#include <span>
#include <vector>

#include "lib/inference/shared_samples.h"

namespace spool {

// One metric of the images of two halves.
struct HalfDifference {
  int columns = 0;
  // [row][column] the cell's part of (a - b) / ((a + b) / 2): they add up to the relative
  // difference of the metric.
  std::vector<double> cells;
  // Where it varies: the samples that a whole replicate took of a piece, and the share of the sum
  // of squared differences of pixels that lies in such pieces, in millionths.
  TakenCounts varying;
  int replicate = 0;  // whose pool was split: its place among the values of a series
};

struct HalfSpread {
  double variance = 0;  // of one image's metric between recordings, of its logarithm
  double freedom = 0;   // 0: not known
};

// `splits`: of one metric; none, or of pictures of several sizes: not known.
HalfSpread half_variance(std::span<const HalfDifference> splits);

// first * a - second * b, cell by cell, of the replicates that both have, each in ascending order;
// empty where sizes differ. Only what halves of one pool share cancels.
std::vector<HalfDifference> difference_of(std::span<const HalfDifference> a, double first,
                                          std::span<const HalfDifference> b, double second);

// The counts of all splits together.
TakenCounts varying_counts(std::span<const HalfDifference> splits);

}  // namespace spool
