#include "lib/pyramid/row_sums.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random_images.h"

namespace spool {
namespace {

constexpr std::ptrdiff_t kStride = 67;

std::vector<double> random_values(std::size_t count, std::uint64_t seed) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = test::normal(seed, i);
  return values;
}

// Every size that vectors, pairs of terms and blocks of rows are cut at, and one beyond it; sums
// are bit for bit those of the plain loops.
class RowSums : public testing::TestWithParam<int> {
 protected:
  const std::vector<double> from_ = random_values(64 * kStride, 1), weights_ = random_values(40, 2);
};

TEST_P(RowSums, OfWeightedRowsAreThoseOfThePlainLoop) {
  const int terms = GetParam();
  std::vector<const double*> sources;
  for (int i = 0; i < terms; ++i)
    sources.push_back(from_.data() + i * kStride + i % 3);
  for (const int width : {1, 7, 8, 17, 33, 64}) {
    std::vector<double> out(65, -1.0);
    weighted_sum_of_rows(sources.data(), weights_.data(), sources.size(), width, out.data());
    for (int x = 0; x < width; ++x) {
      double sum = weights_[0] * sources[0][x];
      for (std::size_t i = 1; i < sources.size(); ++i)
        sum += weights_[i] * sources[i][x];
      ASSERT_EQ(out[static_cast<std::size_t>(x)], sum) << x << " of " << width;
    }
    ASSERT_EQ(out[static_cast<std::size_t>(width)], -1.0) << "written beyond " << width;
  }
}

TEST_P(RowSums, OfManyRowsAreThoseOfEachRow) {
  const int terms = GetParam();
  for (const auto& [rows, width] : {std::pair{1, 64}, {3, 9}, {8, 33}, {11, 16}}) {
    for (const std::ptrdiff_t term_stride : {std::ptrdiff_t{1}, kStride}) {
      if (term_stride == 1 && width + terms > kStride) continue;
      if (term_stride == kStride && rows + terms > 64) continue;
      std::vector<double> weighted(12 * kStride, -1.0), plain(12 * kStride, -1.0);
      weighted_sums(from_.data(), kStride, term_stride, weights_.data(),
                    static_cast<std::size_t>(terms), rows, width, weighted.data(), kStride);
      plain_sums(from_.data(), kStride, term_stride, terms, rows, width, plain.data(), kStride);
      for (int r = 0; r < rows; ++r) {
        for (int x = 0; x < width; ++x) {
          const double* first = from_.data() + r * kStride + x;
          double of_weighted = weights_[0] * first[0], of_plain = first[0];
          for (int i = 1; i < terms; ++i) {
            of_weighted += weights_[static_cast<std::size_t>(i)] * first[i * term_stride];
            of_plain += first[i * term_stride];
          }
          const auto at = static_cast<std::size_t>(r * kStride + x);
          ASSERT_EQ(weighted[at], of_weighted) << rows << " rows, " << x << ", " << r;
          ASSERT_EQ(plain[at], of_plain) << rows << " rows, " << x << ", " << r;
        }
        ASSERT_EQ(weighted[static_cast<std::size_t>(r * kStride + width)], -1.0);
        ASSERT_EQ(plain[static_cast<std::size_t>(r * kStride + width)], -1.0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Terms, RowSums, testing::Values(1, 2, 3, 4, 5, 8, 13, 16, 17, 31, 33));

}  // namespace
}  // namespace spool
