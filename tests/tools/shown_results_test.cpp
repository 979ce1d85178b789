#include "tools/batch/shown_results.h"

#include <gtest/gtest.h>

namespace spool::tools {
namespace {

std::string shown(double low, double high) {
  Interval ratio;
  ratio.n = 4;
  ratio.mean = 1.05;
  ratio.low = low;
  ratio.high = high;
  return ratio_text(ratio);
}

TEST(ShownResults, AnEndOfARatioReadsOneOnlyWhereItIsOne) {
  EXPECT_EQ(shown(0.75, 1.1), "1.05 [0.75, 1.1]");
  EXPECT_EQ(shown(1.003, 1.1), "1.05 [1.003, 1.1]");
  EXPECT_EQ(shown(0.5, 0.9997), "1.05 [0.5, 0.9997]");
  EXPECT_EQ(shown(1.02, 1.2), "1.05 [1.02, 1.2]");
  EXPECT_EQ(shown(0.5, 1.0), "1.05 [0.5, 1]");
}

TEST(ShownResults, ACountIsAWholeNumber) {
  EXPECT_EQ(count_text(384), "380");
  EXPECT_EQ(count_text(12), "12");
  EXPECT_EQ(count_text(31600), "32000");
}

}  // namespace
}  // namespace spool::tools
