// Student's two-sided quantile [Student08] for one level and any number of degrees of freedom, from
// a table.
#pragma once

#include <vector>

namespace spool {

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
