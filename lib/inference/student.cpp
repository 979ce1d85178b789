#include "lib/inference/student.h"

#include <cmath>

#include <boost/math/distributions/students_t.hpp>

#include "lib/core/check.h"

namespace spool {
namespace {

using Student = boost::math::students_t_distribution<double>;

}  // namespace

double student_quantile(double probability, double freedom) {
  SPOOL_CHECK_GT(probability, 0.0);
  SPOOL_CHECK_LT(probability, 1.0);
  return quantile(Student(freedom), probability);
}

double student_cdf(double t, double freedom) {
  return cdf(Student(freedom), t);
}

double student_two_sided(double t, double freedom) {
  if (std::isinf(t)) return 0.0;
  return 2.0 * cdf(complement(Student(freedom), std::abs(t)));
}

}  // namespace spool
