// Mean, standard error and 95 % confidence interval of a few replicates, and of paired differences.
#pragma once

#include <limits>
#include <span>

namespace spool {

struct Interval {
  int n = 0;  // finite values
  double mean = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();  // NaN when n < 2
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

// Over the finite values, at `level`: Student's t-interval with the skewness of the values taken
// into account by Hall's cubic transformation [Hall92]; errors of renderings are skewed to the
// right, and mean -+ t * standard_error then ends too low. Of two or three values, whose skewness
// says nothing, Student's own. It is not symmetric: `high` lies further from a mean of values
// skewed to the right.
Interval mean_interval(std::span<const double> values, double level = 0.95);
// Of a[i] - b[i], over the pairs that are both finite. Sizes must agree.
Interval paired_difference(std::span<const double> a, std::span<const double> b,
                           double level = 0.95);

// Quantile of Student's distribution: P(T <= result) = probability, 0 < probability < 1,
// freedom >= 1. Relative error below 1e-10.
double student_quantile(double probability, double freedom);
// P(T <= t).
double student_cdf(double t, double freedom);

}  // namespace spool
