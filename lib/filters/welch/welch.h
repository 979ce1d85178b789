// Welch's test decides which neighbours a pixel is averaged with [Sakai24].
//
// Per transform lambda and channel: mean and variance v of the mean of the transformed samples
// (transformed_moments.h). With `johnson` a mean is shifted for skewness, by M3 / (6 s^2 n^2)
// [Johnson78]. With `pooled` mean and variance are those of a small neighbourhood: weights of
// sigma 1 and features, radius 3, V = mean of v / effective count. Then
//
//   h = theta t^2 v,   t: Student's two-sided quantile of level alpha, 2 n - 2 degrees of freedom
//
// (n - 1 for kappa = 0; n times the effective count where pooled), and the image is the mean of the
// untransformed pixels that serve (pair_filter.h), weighted by their counts.
//
//   statmc   [Sakai24], from the released code: lambda 0.5, symmetric, features taken as exact. The
//            window here is a whole disc, cut at the border; pieces of less than 4 samples take
//            part of their variance from their neighbours, and a mean counts by its samples
//   moon     [Moon13] as that code has it: lambda 1, the centre's interval alone
//   pooled   this project's: tests between neighbourhoods in two transforms, features with their
//            noise
#pragma once

#include <limits>
#include <vector>

#include "lib/core/option_table.h"
#include "lib/filters/filter.h"
#include "lib/kernels/pair_features.h"
#include "lib/kernels/pair_filter.h"

namespace spool {

struct WelchOptions {
  std::vector<double> lambda = {0.5};
  double alpha = 0.005;
  double theta = 1.0;
  double kappa = std::numeric_limits<double>::infinity();
  bool johnson = true;
  bool pooled = false;
  PairWindow window = {20, 10.0};
  PairFeatureOptions features;
};

Filter welch_filter();

}  // namespace spool
