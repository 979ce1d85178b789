#include "lib/pyramid/wavelet_filters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

namespace spool {
namespace {

constexpr WaveletFilter kFilters[] = {WaveletFilter::kHaar, WaveletFilter::k53, WaveletFilter::k97,
                                      WaveletFilter::kDb3};
constexpr FilterRoles kRoles[] = {FilterRoles::kLongAnalysis, FilterRoles::kSwapped};

double sum_of(const Taps& taps) {
  return std::accumulate(taps.values.begin(), taps.values.end(), 0.0);
}

TEST(WaveletFilters, AnalysisSumsToOneAndSynthesisToTwo) {
  for (const WaveletFilter filter : kFilters) {
    for (const FilterRoles roles : kRoles) {
      const FilterPair pair = filter_pair(filter, roles);
      EXPECT_NEAR(sum_of(pair.analysis), 1.0, 2e-14);
      EXPECT_NEAR(sum_of(pair.synthesis), 2.0, 2e-14);
    }
  }
}

// down(h * (g * up(c))) = c says: sum_m h(2 n - m) g(m) = [n = 0].
TEST(WaveletFilters, PairsAreBiorthogonalAtEveryAlignment) {
  for (const WaveletFilter filter : kFilters) {
    for (const FilterRoles roles : kRoles) {
      for (int k = 0; k < 2; ++k) {
        const auto [h, g] = filter_pair_at(filter, roles, k);
        std::map<int, double> product;
        for (int a = h.first; a <= h.last(); ++a) {
          for (int b = g.first; b <= g.last(); ++b) {
            product[a + b] += h.values[static_cast<std::size_t>(a - h.first)] *
                              g.values[static_cast<std::size_t>(b - g.first)];
          }
        }
        for (const auto& [offset, value] : product) {
          if (offset % 2 != 0) continue;
          EXPECT_NEAR(value, offset == 0 ? 1.0 : 0.0, 2e-14) << offset;
        }
      }
    }
  }
}

TEST(WaveletFilters, TapsAreTheTabulatedOnes) {
  const Taps h = filter_pair(WaveletFilter::k53).analysis;
  EXPECT_EQ(h.first, -2);
  EXPECT_EQ(h.values, (std::vector<double>{-0.125, 0.25, 0.75, 0.25, -0.125}));
  const Taps short_h = filter_pair(WaveletFilter::k53, FilterRoles::kSwapped).analysis;
  EXPECT_EQ(short_h.first, -1);
  EXPECT_EQ(short_h.values, (std::vector<double>{0.25, 0.5, 0.25}));
  const Taps db3 = filter_pair(WaveletFilter::kDb3).analysis;
  EXPECT_EQ(db3.first, -1);
  const double expected[] = {0.2352336039,  0.5705584579,  0.3251825003,
                             -0.0954672078, -0.0604161042, 0.0249087499};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(db3.values[i], expected[i], 5e-11);
}

TEST(WaveletFilters, Db3HasThreeVanishingMoments) {
  const Taps h = filter_pair(WaveletFilter::kDb3).analysis;
  for (int power = 0; power < 3; ++power) {
    double moment = 0.0;
    for (int i = 0; i < 6; ++i) {
      moment +=
          (i % 2 == 0 ? 1.0 : -1.0) * std::pow(i, power) * h.values[static_cast<std::size_t>(i)];
    }
    EXPECT_NEAR(moment, 0.0, 1e-14) << power;
  }
}

// Unmirrored, haar would drift by half a step of every level: +7.5 pieces at K = 4.
TEST(WaveletFilters, MirroringAtOddLevelsKeepsHaarCentred) {
  double centroid = 0.0;
  for (int k = 0; k < 4; ++k) {
    const Taps h = filter_pair_at(WaveletFilter::kHaar, FilterRoles::kLongAnalysis, k).analysis;
    for (int m = h.first; m <= h.last(); ++m)
      centroid += h.values[static_cast<std::size_t>(m - h.first)] * m * (1 << k);
  }
  EXPECT_DOUBLE_EQ(centroid, -2.5);
}

TEST(WaveletFilters, GaussianIsNormalisedSymmetricAndCutAtThreeSigma) {
  for (const double sigma : {0.3, 0.8, 1.0, 5.6}) {
    const Taps taps = gaussian_taps(sigma);
    EXPECT_EQ(taps.last(), static_cast<int>(std::ceil(3.0 * sigma)));
    EXPECT_EQ(taps.first, -taps.last());
    EXPECT_NEAR(sum_of(taps), 1.0, 1e-15);
    EXPECT_EQ(taps.values, mirrored(taps).values);
    EXPECT_NEAR(std::log(taps.values[static_cast<std::size_t>(taps.last())] /
                         taps.values[static_cast<std::size_t>(taps.last() + 1)]),
                0.5 / (sigma * sigma), 1e-12);
  }
}

}  // namespace
}  // namespace spool
