#include "tools/batch/shown_results.h"

#include <gtest/gtest.h>

namespace spool::tools {
namespace {

Interval interval(double mean, double low, double high) {
  Interval found;
  found.n = 4;
  found.mean = mean;
  found.low = low;
  found.high = high;
  return found;
}

std::string shown(double low, double high) {
  return ratio_text(interval(1.05, low, high));
}

TEST(ShownResults, AnEndOfARatioReadsOneOnlyWhereItIsOne) {
  EXPECT_EQ(shown(0.75, 1.1), "1.05 [0.75, 1.1]");
  EXPECT_EQ(shown(1.003, 1.1), "1.05 [1.003, 1.1]");
  EXPECT_EQ(shown(0.5, 0.9997), "1.05 [0.5, 0.9997]");
  EXPECT_EQ(shown(1.02, 1.2), "1.05 [1.02, 1.2]");
  EXPECT_EQ(shown(0.5, 1.0), "1.05 [0.5, 1]");
}

TEST(ShownResults, ARatioReadsOneOnlyWhereItIsOne) {
  EXPECT_EQ(ratio_text(interval(0.99961, 0.9996, 0.99962)), "0.9996 [0.9996, 0.9996]");
  EXPECT_EQ(ratio_text(interval(1.0004, 1.0002, 1.0006)), "1.0004 [1.0002, 1.001]");
  EXPECT_EQ(ratio_text(interval(1.00004, 1.00001, 1.0001), 4, 4), "1.00004 [1.00001, 1.0001]");
  EXPECT_EQ(ratio_text(interval(1.0, 1.0, 1.0)), "1 [1, 1]");
}

TEST(ShownResults, APrintedMeanLiesWithinItsPrintedEnds) {
  EXPECT_EQ(ratio_text(interval(1.09, 1.074, 1.11)), "1.09 [1.07, 1.1]");
  EXPECT_EQ(ratio_text(interval(1.16, 1.02, 1.161)), "1.16 [1.02, 1.2]");
  EXPECT_EQ(ratio_text(interval(0.123456, 0.123456, 0.123456)), "0.123 [0.12, 0.123]");
  EXPECT_EQ(value_text(interval(0.12345, 0.123449, 0.123451), "{:.4g}"), "0.1235 [0.123, 0.1235]");
  EXPECT_EQ(value_text(interval(-0.12345, -0.123451, -0.123449), "{:.4g}"),
            "-0.1235 [-0.1235, -0.123]");
  EXPECT_EQ(value_text(interval(0.0023, 0.0011, 0.0047), "{:.3g}"), "0.0023 [0.0011, 0.0047]");
}

TEST(ShownResults, ACountIsAWholeNumber) {
  EXPECT_EQ(count_text(384), "380");
  EXPECT_EQ(count_text(12), "12");
  EXPECT_EQ(count_text(31600), "32000");
}

}  // namespace
}  // namespace spool::tools
