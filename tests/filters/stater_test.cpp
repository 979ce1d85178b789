// StatER as a filter: its parts against slow twins, and what each part is for.
#include "lib/filters/welch/stater.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/core/student.h"
#include "lib/filters/welch/pair_intervals.h"
#include "lib/kernels/denoised_variance.h"
#include "tests/reference/stater_reference.h"
#include "tests/support/every_method.h"
#include "tests/support/film_recording.h"
#include "tests/support/memory_pool.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

// A slope, an edge, and noise.
SamplePool sloped_pool(int width, int height) {
  return test::pool_of(
      test::film_recording(width, height, 16, [](int x, int y, int s, FilmPosition film) {
        Rgb value;
        for (std::size_t c = 0; c < 3; ++c) {
          const double u = unit_double(mix(5, x, y, s, static_cast<int>(c)));
          value[c] = static_cast<float>((x < 6 ? 0.3 : 1.4) + 0.6 * static_cast<double>(film.x) +
                                        0.8 * u * u);
        }
        return value;
      }));
}

CountImage counts_from_four(int width, int height) {
  CountImage n(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      n(x, y) = 4 + static_cast<int>(12.99 * unit_double(mix(6, x, y)));
  }
  return n;
}

TEST(Stater, VariancesAndImageAreThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const SamplePool pool = sloped_pool(width, height);
    const CountImage n = counts_from_four(width, height);
    const Selection selection{prefix_statistics(pool, n), {}};
    GuardCounts guards;
    reference::StaterCase at;
    at.unit = test_unit(selection.statistics);
    at.features = *pair_features(pool, n, {}, guards);
    at.window = {20, 10.0};
    for (const std::string preset : {"mcl", "mc", "m"}) {
      at.cascade = preset != "m";
      at.slope = preset == "mcl";
      std::vector<reference::StaterCase> cases;
      for (const double lambda : {0.25, 1.0}) {
        cases.push_back(at);
        cases.back().lambda = lambda;
      }
      const RgbImage expected = reference::stater(pool, n, cases, StudentTable(0.005));
      const auto result = (*stater_filter().make(preset, {}))(selection, pool, FilterContext{});
      ASSERT_TRUE(result.has_value());
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < n.size(); ++i)
          ASSERT_NEAR(result->image[c][i], expected[c][i], 1e-5) << preset << " at " << i;
      }
    }
  }
}

// Noise without a slope, and a slope without noise: variance 1 / 12 of a plane of slope 1.
TEST(Stater, ASlopeIsTakenOffAVarianceAndNoiseIsNot) {
  const SamplePool pool =
      test::pool_of(test::film_recording(8, 8, 400, [](int x, int y, int s, FilmPosition film) {
        const auto noise = static_cast<float>(unit_double(mix(3, x, y, s)));
        return Rgb{noise, film.x, film.x + noise};
      }));
  const CountImage n(8, 8, 400);
  const TransformedMoments moments = transformed_moments(pool, n, 1.0, 1.0, HighestMoment::kFourth);
  SampleVariances variances = sample_variances(moments, n, 1);
  const RgbImage before = variances.value;
  correct_for_slope(variances, film_covariance(pool, n, 1.0, 1.0, moments.mean), n);
  for (std::size_t i = 0; i < n.size(); ++i) {
    EXPECT_NEAR(before[1][i], 1.0 / 12, 0.012);
    EXPECT_NEAR(before[2][i], 2.0 / 12, 0.03);
    EXPECT_GT(variances.value[0][i], 0.95 * before[0][i]);
    EXPECT_LT(variances.value[1][i], 0.15 * before[1][i]);  // at least a twentieth is left
    EXPECT_NEAR(variances.value[2][i] / before[2][i], 0.5, 0.12);
  }
}

// Film positions of a quarter pixel lie in its own square.
TEST(Stater, PlacesAreThoseInThePiece) {
  PoolOptions options;
  options.pieces_per_side = 2;
  const SamplePool pool = test::pool_of(
      test::film_recording(
          4, 4, 64, [](int, int, int, FilmPosition film) { return Rgb{film.x, film.y, 1.0f}; }),
      options);
  CountImage n(8, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x)
      n(x, y) = pool.capacity(x, y);
  }
  const TransformedMoments moments = transformed_moments(pool, n, 1.0, 1.0);
  const FilmCovariance film = film_covariance(pool, n, 1.0, 1.0, moments.mean);
  for (std::size_t i = 0; i < n.size(); ++i) {
    // In [0, 1) across the piece radiance grows by 1 / 2.
    EXPECT_NEAR(film.x[0][i], 2.0 * moments.m2[0][i], 1e-6);
    EXPECT_NEAR(film.y[1][i], 2.0 * moments.m2[1][i], 1e-6);
    EXPECT_NEAR(film.y[2][i], 0.0, 1e-9);
  }
}

// Pixels of like variance share theirs; beside louder ones they keep it.
TEST(Stater, VariancesAreAveragedOverLikeNeighboursOnly) {
  const SamplePool pool = test::memory_pool(32, 16, 32, [](int x, int y, int s) {
    const double u = unit_double(mix(9, x, y, s)) - 0.5;
    const auto v = static_cast<float>(1.0 + (x < 16 ? 0.1 : 3.0) * u);
    return Rgb{v, v, v};
  });
  const CountImage n(32, 16, 32);
  const SampleVariances variances =
      sample_variances(transformed_moments(pool, n, 1.0, 1.0, HighestMoment::kFourth), n, 1);
  const RgbImage denoised = denoised_variance(variances, {}, float_counts(n), {20, 10.0});
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      const double truth = (x < 16 ? 0.01 : 9.0) / 12;
      before += std::pow(variances.value[1](x, y) / truth - 1, 2);
      after += std::pow(denoised[1](x, y) / truth - 1, 2);
    }
  }
  EXPECT_LT(after, 0.02 * before);
}

TEST(Stater, SaysThatFilmPositionsAreMissing) {
  const SamplePool pool = test::memory_pool(
      6, 5, 8, [](int, int, int s) { return Rgb{1.0f, static_cast<float>(s), 1.0f}; });
  const Selection selection = test::select_uniform(pool, 8);
  const auto notes = [&](const std::string& preset) {
    return (*stater_filter().make(preset, {}))(selection, pool, FilterContext{})->notes.size();
  };
  EXPECT_EQ(notes("mcl"), 1u);
  EXPECT_EQ(notes("mc"), 0u);
}

}  // namespace
}  // namespace spool
