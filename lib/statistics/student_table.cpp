#include "lib/statistics/student_table.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>

#include "lib/core/check.h"

namespace spool {
namespace {

constexpr int kLargestFreedom = 1024;

}  // namespace

StudentTable::StudentTable(double alpha) {
  SPOOL_CHECK(alpha > 0.0 && alpha < 1.0);
  for (int freedom = 1; freedom <= kLargestFreedom; ++freedom) {
    const boost::math::students_t_distribution<double> student(freedom);
    quantiles_.push_back(boost::math::quantile(boost::math::complement(student, alpha / 2.0)));
  }
}

double StudentTable::operator()(double freedom) const {
  const double at = std::clamp(freedom, 1.0, static_cast<double>(kLargestFreedom)) - 1.0;
  const auto i = static_cast<std::size_t>(at);
  const std::size_t next = std::min(i + 1, quantiles_.size() - 1);
  return quantiles_[i] + (at - static_cast<double>(i)) * (quantiles_[next] - quantiles_[i]);
}

}  // namespace spool
