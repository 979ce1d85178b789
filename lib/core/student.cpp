#include "lib/core/student.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <boost/math/distributions/students_t.hpp>

#include "lib/core/check.h"

namespace spool {
namespace {

using Student = boost::math::students_t_distribution<double>;
// In double throughout: to some 1e-14, in a third of the time of the default, which takes long
// double on the way. Filters keep that one (StudentTable), as a bit may decide a pixel.
namespace policies = boost::math::policies;
using InDouble = policies::policy<policies::promote_double<false>>;
using QuickStudent = boost::math::students_t_distribution<double, InDouble>;

constexpr int kLargestFreedom = 1024;  // of the table

}  // namespace

double student_quantile(double probability, double freedom) {
  SPOOL_CHECK_GT(probability, 0.0);
  SPOOL_CHECK_LT(probability, 1.0);
  // The quantities of one method have the degrees of freedom of its replicates, and a quantile
  // takes as long as a thousand steps of other arithmetic.
  struct Kept {
    double probability = 0.0, freedom = 0.0, quantile = 0.0;
  };
  thread_local std::array<Kept, 1024> all;
  const auto bits =
      std::bit_cast<std::uint64_t>(freedom) + std::bit_cast<std::uint64_t>(probability);
  Kept& kept = all[(bits * 0x9E3779B97F4A7C15ULL) >> 54];
  if (kept.probability != probability || kept.freedom != freedom)
    kept = {probability, freedom, quantile(QuickStudent(freedom), probability)};
  return kept.quantile;
}

double student_two_sided(double t, double freedom) {
  if (std::isinf(t)) return 0.0;
  return 2.0 * cdf(complement(QuickStudent(freedom), std::abs(t)));
}

StudentTable::StudentTable(double alpha) {
  SPOOL_CHECK(alpha > 0.0 && alpha < 1.0);
  for (int freedom = 1; freedom <= kLargestFreedom; ++freedom)
    quantiles_.push_back(quantile(complement(Student(freedom), alpha / 2.0)));
}

double StudentTable::operator()(double freedom) const {
  const double at = std::clamp(freedom, 1.0, static_cast<double>(kLargestFreedom)) - 1.0;
  const auto i = static_cast<std::size_t>(at);
  const std::size_t next = std::min(i + 1, quantiles_.size() - 1);
  return quantiles_[i] + (at - static_cast<double>(i)) * (quantiles_[next] - quantiles_[i]);
}

}  // namespace spool
