// StatER, a filter by Welch's test in several transforms whose variances are denoised first
// [Sakai25]. From descriptions: its host program is public, its kernels and the text were not at
// hand.
//
//   v_lambda = s^2 / n of the samples transformed with lambda; of the mean
//   cascade: s^2 is the mean of s^2 over neighbours of like variance (denoised_variance.h)
//   slope:   without what a plane through the pixel explains, where film positions were recorded
//   q serves p   iff (m_p - m_q)^2 <= t_p^2 v_p + t_q^2 v_q in every transform and channel
//
// t: Student's quantile of 2 n - 2 degrees of freedom, level 0.005. The image is the weighted mean
// of the untransformed pixels that serve (pair_filter.h), weighted by their counts, too.
//
//   mcl   transforms 1 and 0.25, cascade and slope      mc, m   without slope; without both
#pragma once

#include <vector>

#include "lib/core/option_table.h"
#include "lib/filters/filter.h"
#include "lib/kernels/pair_features.h"
#include "lib/kernels/pair_filter.h"

namespace spool {

struct StaterOptions {
  std::vector<double> lambda = {0.25, 1.0};
  double alpha = 0.005;
  bool cascade = true;
  bool slope = true;
  PairWindow window = {20, 10.0};
  PairFeatureOptions features;  // of the variances and of the means
};

Filter stater_filter();

}  // namespace spool
