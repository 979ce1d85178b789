#include "lib/statistics/piece_statistics.h"

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "tests/reference/statistics_reference.h"
#include "tests/statistics/statistics_cases.h"

namespace spool {
namespace {

using test::memory_pool;
using test::uneven_counts;
using test::wild_radiance;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PieceStatistics, EqualTheTwoPassTwin) {
  const SamplePool pool = memory_pool(13, 9, 20, wild_radiance);
  const CountImage counts = uneven_counts(13, 9, 20);
  AnalysisSignal signal;
  signal.exposure = 0.37;
  const PieceStatistics fast = prefix_statistics(pool, counts, signal, true);
  EXPECT_EQ(fast.n, counts);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 13; ++x) {
      std::vector<double> scalar;
      for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> values;
        for (int s = 0; s < counts(x, y); ++s)
          values.push_back(pool.sample(x, y, s)[c]);
        const reference::ScalarSummary slow = reference::summary(values);
        const double size = std::abs(slow.mean) + std::sqrt(slow.m2);
        EXPECT_NEAR(fast.mean[c](x, y), slow.mean, 1e-14 * size);
        EXPECT_NEAR(fast.m2[c](x, y), slow.m2, 1e-11 * slow.m2 + 1e-25 * size * size);
        EXPECT_GE(fast.m2[c](x, y), 0.0);
        EXPECT_EQ((*fast.channel_minimum)[c](x, y), slow.minimum);
        EXPECT_EQ((*fast.channel_maximum)[c](x, y), slow.maximum);
      }
      for (int s = 0; s < counts(x, y); ++s) {
        const Rgb v = pool.sample(x, y, s);
        scalar.push_back(0.37 * (0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]));
      }
      const reference::ScalarSummary slow = reference::summary(scalar);
      EXPECT_NEAR(fast.analysis.mean(x, y), slow.mean, 1e-13 * (1 + std::abs(slow.mean)));
      EXPECT_NEAR(fast.analysis.m2(x, y), slow.m2, 1e-11 * (1e-9 + slow.m2));
      if (counts(x, y) > 0) {
        EXPECT_NEAR(fast.analysis.minimum(x, y), slow.minimum, 1e-12 * (1 + slow.minimum));
      } else {
        EXPECT_EQ(fast.analysis.minimum(x, y), kInfinity);
        EXPECT_EQ(fast.analysis.maximum(x, y), -kInfinity);
      }
    }
  }
}

TEST(PieceStatistics, LargeMeansKeepTheirSmallVariance) {
  // Mean 1000, sigma 0.05: sums of squares in float lose this altogether.
  const SamplePool pool = memory_pool(1, 1, 64, [](int, int, int s) -> Rgb {
    const float v = 1000.0f + (s % 2 == 0 ? 0.0625f : -0.0625f);
    return {v, v, v};
  });
  const PieceStatistics statistics = prefix_statistics(pool, CountImage(1, 1, 64));
  EXPECT_NEAR(statistics.m2[0](0, 0), 64 * 0.0625 * 0.0625, 1e-12);
}

TEST(PieceStatistics, TakingInTwoStepsEqualsTakingAtOnce) {
  const SamplePool pool = memory_pool(5, 4, 12, wild_radiance);
  PieceStatistics steps = empty_statistics(pool);
  EXPECT_EQ(take_everywhere(steps, pool, 5), 5 * 20);
  for (int i = 0; i < 7; ++i)
    take(steps, pool, 3, 2);
  PieceStatistics once = empty_statistics(pool);
  take_everywhere(once, pool, 5);
  take(once, pool, 3, 2, 7);
  EXPECT_EQ(steps, once);
  EXPECT_EQ(take_everywhere(once, pool, 12), 7 * 19);  // the full piece gives nothing more
  EXPECT_EQ(once.n(0, 0), 12);
}

TEST(PieceStatistics, BitsDoNotDependOnTheNumberOfThreads) {
  const SamplePool pool = memory_pool(40, 31, 9, wild_radiance);
  const CountImage counts = uneven_counts(40, 31, 9);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return prefix_statistics(pool, counts);
  };
  const PieceStatistics once = run(1);
  EXPECT_EQ(run(2), once);
  EXPECT_EQ(run(5), once);
}

TEST(SetSignal, ExposureEqualsAccumulatingAnew) {
  const SamplePool pool = memory_pool(9, 7, 8, wild_radiance);
  const CountImage counts = uneven_counts(9, 7, 8);
  AnalysisSignal bright;
  bright.exposure = 1.0 / 3.0;
  PieceStatistics exposed = prefix_statistics(pool, counts);
  set_signal(exposed, pool, bright);
  EXPECT_EQ(exposed, prefix_statistics(pool, counts, bright));
}

TEST(SetSignal, AnotherChannelReadsThePrefixesAgain) {
  const SamplePool pool = memory_pool(9, 7, 8, wild_radiance);
  const CountImage counts = uneven_counts(9, 7, 8);
  AnalysisSignal other;
  other.channel = AnalysisChannel::kMaxRgb;
  PieceStatistics changed = prefix_statistics(pool, counts);
  set_signal(changed, pool, other);
  EXPECT_EQ(changed, prefix_statistics(pool, counts, other));
  set_signal(changed, pool, {});
  EXPECT_EQ(changed, prefix_statistics(pool, counts));
}

TEST(AnalysisSignal, ValueByHand) {
  AnalysisSignal signal;
  signal.exposure = 2.0;
  EXPECT_DOUBLE_EQ(signal.value({1.0f, 0.5f, 0.25f}),
                   2.0 * (0.2126 + 0.7152 * 0.5 + 0.0722 * 0.25));
  signal.channel = AnalysisChannel::kMaxRgb;
  EXPECT_EQ(signal.value({1.0f, 3.0f, 0.25f}), 6.0);
}

TEST(Exposure, EqualsTheTwinAndCountsItsFallback) {
  Plane values(30, 20);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = unit_double(mix(5, i)) < 0.02 ? 1e6 : unit_double(mix(6, i));
  const CountImage n = uneven_counts(30, 20, 3);
  GuardCounts guards;
  EXPECT_NEAR(exposure_scale(values, n, guards), reference::exposure(values, n), 1e-12);
  EXPECT_EQ(guards[Guard::kExposureFallback], 0u);
  EXPECT_EQ(exposure_scale(Plane(4, 4), CountImage(4, 4, 1), guards), 1.0);
  EXPECT_EQ(exposure_scale(values, CountImage(30, 20), guards), 1.0);
  EXPECT_EQ(exposure_scale(Plane(4, 4, -1.0), CountImage(4, 4, 1), guards), 1.0);
  EXPECT_EQ(guards[Guard::kExposureFallback], 3u);
}

TEST(Exposure, PowersOfTwoInTheRadianceLeaveTheExposedSignalUnchangedToTheBit) {
  const auto exposed = [](float factor) {
    const SamplePool pool = memory_pool(12, 10, 6, [factor](int x, int y, int s) {
      Rgb v = wild_radiance(x, y, s);
      for (float& c : v)
        c *= factor;
      return v;
    });
    PieceStatistics statistics = prefix_statistics(pool, CountImage(12, 10, 6));
    GuardCounts guards;
    AnalysisSignal signal;
    signal.exposure = exposure_of(statistics, guards);
    set_signal(statistics, pool, signal);
    return statistics.analysis;
  };
  const ScalarStatistics once = exposed(1.0f);
  for (const float factor : {0x1p-20f, 0.5f, 4.0f, 0x1p20f})
    EXPECT_EQ(exposed(factor), once) << factor;
}

TEST(Exposure, OfExposedStatisticsIsTheSame) {
  const SamplePool pool = memory_pool(12, 10, 6, wild_radiance);
  PieceStatistics statistics = prefix_statistics(pool, CountImage(12, 10, 6));
  GuardCounts guards;
  const double first = exposure_of(statistics, guards);
  AnalysisSignal signal;
  signal.exposure = 4.0;
  set_signal(statistics, pool, signal);
  EXPECT_EQ(exposure_of(statistics, guards), first);
}

TEST(PixelMeans, FillEmptyPiecesFromTheirPixelThenFromTheNearestPiece) {
  // q = 2, two pixels; the right one is empty but for its piece (3, 0) ...
  CountImage n(4, 2);
  Plane pieces(4, 2);
  n(0, 0) = 1, pieces(0, 0) = 2.0;
  n(1, 1) = 3, pieces(1, 1) = 4.0;
  n(3, 0) = 1, pieces(3, 0) = 10.0;
  GuardCounts guards;
  Plane filled = fill_empty_pieces(pieces, n, 2, guards);
  EXPECT_EQ(filled(1, 0), 3.0);  // the mean of its pixel's sampled pieces
  EXPECT_EQ(filled(2, 1), 10.0);
  EXPECT_EQ(guards[Guard::kEmptyPiece], 5u);
  EXPECT_EQ(pieces_to_pixels(pieces, n, 2, guards)(0, 0), 3.0);
  EXPECT_EQ(pieces_to_pixels(pieces, n, 2, guards)(1, 0), 10.0);
  // ... and then altogether: its nearest sampled piece is (1, 1), one ring and no row away.
  n(3, 0) = 0;
  filled = fill_empty_pieces(pieces, n, 2, guards);
  EXPECT_EQ(filled(2, 1), 4.0);
  EXPECT_EQ(filled(2, 0), 4.0);
}

TEST(PixelMeans, NearestFillEqualsTheTwin) {
  const SamplePool pool = memory_pool(23, 17, 1, wild_radiance);
  CountImage counts(23, 17);
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] = mix(3, i) % 13 == 0 ? 1 : 0;
  const PieceStatistics statistics = prefix_statistics(pool, counts);
  GuardCounts guards;
  const RgbImage means = pixel_means(statistics, guards);
  std::uint64_t empty = 0;
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 23; ++x) {
      empty += counts(x, y) == 0;
      EXPECT_EQ(means[1](x, y), reference::nearest_value(statistics.mean[1], counts, x, y));
    }
  }
  EXPECT_EQ(guards[Guard::kEmptyPiece], empty);
}

// Of a mask that leaves one corner, say: a search of each pixel from ring to ring takes an hour.
TEST(PixelMeans, FewSamplesFillALargePicture) {
  CountImage n(600, 600);
  Plane pieces(600, 600);
  n(599, 0) = n(0, 599) = 1;
  pieces(599, 0) = 1.0, pieces(0, 599) = 2.0;
  GuardCounts guards;
  const Plane filled = fill_empty_pieces(pieces, n, 1, guards);
  for (int y = 0; y < 600; ++y) {
    for (int x = 0; x < 600; ++x)
      ASSERT_EQ(filled(x, y), x < y ? 2.0 : 1.0) << x << "," << y;
  }
}

TEST(PixelMeans, WithoutAnySampleAreZero) {
  const SamplePool pool = memory_pool(3, 2, 1, wild_radiance);
  GuardCounts guards;
  const RgbImage means = pixel_means(empty_statistics(pool), guards);
  for (const double v : means[0].pixels())
    EXPECT_EQ(v, 0.0);
}

}  // namespace
}  // namespace spool
