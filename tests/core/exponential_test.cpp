#include "lib/core/exponential.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

// Distance of `value` from the exact result, in units of the exact result's last place.
template <class T>
double error_in_ulp(T value, long double exact) {
  const T nearest = static_cast<T>(exact);
  const T ulp = std::nextafter(nearest, std::numeric_limits<T>::infinity()) - nearest;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) /
                             static_cast<long double>(ulp));
}

template <class T>
double largest_error(T end) {
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 1u << 20; ++i) {
    const T x = static_cast<T>(unit_double(mix(3, i))) * (i % 2 == 0 ? end : T{2});
    worst = std::max(worst, error_in_ulp(exp_negative(x), std::exp(-static_cast<long double>(x))));
  }
  return worst;
}

TEST(ExpNegative, FloatIsWithin2Ulp) {
  const double worst = largest_error(87.3f);
  RecordProperty("largest_ulp", std::to_string(worst));
  EXPECT_LT(worst, 2.0);
}

TEST(ExpNegative, DoubleIsWithin2Ulp) {
  const double worst = largest_error(708.0);
  RecordProperty("largest_ulp", std::to_string(worst));
  EXPECT_LT(worst, 2.0);
}

TEST(ExpNegative, EndsOfTheRange) {
  EXPECT_EQ(exp_negative(0.0f), 1.0f);
  EXPECT_EQ(exp_negative(0.0), 1.0);
  EXPECT_EQ(exp_negative(1e30f), 0.0f);
  EXPECT_EQ(exp_negative(std::numeric_limits<float>::infinity()), 0.0f);
  EXPECT_EQ(exp_negative(std::numeric_limits<double>::infinity()), 0.0);
  EXPECT_GT(exp_negative(87.2f), 0.0f);
  EXPECT_GT(exp_negative(707.9), 0.0);
}

TEST(ExpNegative, NeverGrowsByMoreThanRounding) {
  float before = 1.0f;
  for (int i = 0; i < 900000; ++i) {
    const float now = exp_negative(1e-4f * static_cast<float>(i));
    ASSERT_LE(now, before * (1.0f + 2.5e-7f)) << i;
    before = now;
  }
}

}  // namespace
}  // namespace spool
