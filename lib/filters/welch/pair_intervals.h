// What filters by tests of pairs share: intervals around means, means over the neighbours that
// serve, and the options of both.
#pragma once

#include <functional>

#include "lib/core/option_table.h"
#include "lib/core/student.h"
#include "lib/filters/filter.h"
#include "lib/kernels/pair_features.h"
#include "lib/kernels/pair_filter.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

struct IntervalRule {
  double theta = 1.0;         // factor on the squared half widths
  bool centre_alone = false;  // n - 1 degrees of freedom, not 2 n - 2
};

// Adds the test of three channels: means, variances of means, of `samples` samples [y][x].
void add_test(PairTest& test, const RgbImage& mean, const RgbImage& variance, const Plane& samples,
              const IntervalRule& rule, const StudentTable& student);

// A power of two that brings radiance near 1, where roots differ from logarithms.
double test_unit(const PieceStatistics& statistics);

// The filter around a test: means over the neighbours that serve, weighted by their counts, and the
// weights in the pixels that `context` asks for. Where none serves an empty piece keeps the value
// that its neighbours gave it. Errors: those of features.
Result<Reconstruction> reconstruct_by_test(
    const Selection& selection, const SamplePool& pool, const PairFeatureOptions& of_features,
    const PairWindow& window, const FilterContext& context,
    const std::function<PairTest(const PairFeatures&)>& test_of);

OptionTable<PairFeatureOptions> pair_feature_option_table();
OptionTable<PairWindow> pair_window_option_table();

}  // namespace spool
