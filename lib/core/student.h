// Student's distribution [Student08], by Boost.Math.
#pragma once

#include <vector>

namespace spool {

// t with P(T <= t) = probability, 0 < probability < 1, freedom >= 1 (need not be whole).
double student_quantile(double probability, double freedom);
// P(|T| >= |t|); 0 where t is infinite.
double student_two_sided(double t, double freedom);

// The two-sided quantile for one level and any number of degrees of freedom, from a table.
class StudentTable {
 public:
  // 0 < alpha < 1: the share of differences that are refused although there is none.
  explicit StudentTable(double alpha);

  // t with P(|T| > t) = alpha. Freedom below 1 counts as 1, beyond 1024 as 1024; between whole
  // numbers the value is interpolated.
  double operator()(double freedom) const;

 private:
  std::vector<double> quantiles_;  // of 1, 2, .. degrees of freedom
};

}  // namespace spool
