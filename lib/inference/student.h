// Student's distribution [Student08], by Boost.Math.
#pragma once

namespace spool {

// t with P(T <= t) = probability, 0 < probability < 1, freedom >= 1 (need not be whole).
double student_quantile(double probability, double freedom);
// P(T <= t).
double student_cdf(double t, double freedom);
// P(|T| >= |t|); 0 where t is infinite.
double student_two_sided(double t, double freedom);

}  // namespace spool
