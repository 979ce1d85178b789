// Greedy error minimisation and NL-means sampling against slow twins.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/sampling/cross_bilateral.h"
#include "lib/sampling/filter_disagreement.h"
#include "lib/sampling/greedy_error.h"
#include "lib/sampling/nl_means.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "tests/reference/cross_bilateral_reference.h"
#include "tests/reference/greedy_error_reference.h"
#include "tests/reference/nl_means_reference.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/cell_means.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

// Two areas of unlike noise with an edge between them.
std::shared_ptr<const RecordedSamples> edge_recording(int width, int height, int spp, bool film) {
  std::vector<float> radiance(3u * width * height * spp);
  const std::size_t plane = static_cast<std::size_t>(width) * height * spp;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < spp; ++s) {
        for (std::size_t c = 0; c < 3; ++c) {
          const double u = unit_double(mix(6, x, y, s, c));
          radiance[c * plane + (static_cast<std::size_t>(y) * width + x) * spp + s] =
              static_cast<float>(x < width / 2 ? 0.3 + 0.1 * u : 1.0 + u);
        }
      }
    }
  }
  auto recording = RecordedSamples::from_memory("edge", width, height, spp, std::move(radiance));
  if (film) {
    std::vector<FilmPosition> positions;
    for (int i = 0; i < width * height * spp; ++i) {
      positions.push_back(
          {static_cast<float>(unit_double(mix(1, i))), static_cast<float>(unit_double(mix(2, i)))});
    }
    recording->set_sample_film(positions);
  }
  return std::make_shared<const RecordedSamples>(std::move(*recording));
}

TEST(GreedyError, ErrorsAndScalesAgreeWithTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    for (const auto& [subpixel, film] : {std::pair{false, false}, {true, true}, {true, false}}) {
      const SamplePool pool = test::pool_of(edge_recording(width, height, 9, film));
      CountImage counts(width, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
          counts(x, y) = 4 + (3 * x + y) % 5;
      }
      PieceStatistics statistics = prefix_statistics(pool, counts);
      GuardCounts guards;
      expose(statistics, pool, guards);
      GreedyErrorOptions options;
      options.scales = 3;
      options.grid = subpixel ? GreedyGrid::kSubpixel : GreedyGrid::kPixel;
      const auto map = greedy_error_map(statistics, pool, 8.0, options, guards);
      ASSERT_TRUE(map.has_value());
      const double exposure = statistics.signal.exposure;
      const auto pieces = estimate_pieces(statistics, {}, exposure, guards);
      Plane n(width, height);
      for (std::size_t i = 0; i < n.size(); ++i)
        n[i] = counts[i];
      const RgbImage cells = test::cell_means(statistics, pool, statistics.mean);
      const auto expected =
          reference::greedy_error(pieces->mean, pieces->variance, n, subpixel ? &cells : nullptr,
                                  exposure, 8.0, 3, options.gamma, options.alpha);
      for (std::size_t i = 0; i < n.size(); ++i) {
        if (expected.margin[i] < 1e-12) continue;  // decided by rounding
        ASSERT_EQ(map->scale[i], expected.scale[i]) << width << "x" << height << subpixel;
        ASSERT_NEAR(map->error[i], expected.error[i], 1e-12) << width << "x" << height;
      }
    }
  }
}

TEST(GreedyError, SamplesGoToTheNoisyHalfAndTheEdge) {
  const SamplePool pool = test::pool_of(edge_recording(32, 32, 64, false));
  const auto result = sample_greedy_error(pool, 32 * 32 * 12, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 32 * 32 * 12);
  double flat = 0.0, edge = 0.0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 4; x < 8; ++x)
      flat += result->selection.statistics.n(x, y);
    for (int x = 14; x < 18; ++x)
      edge += result->selection.statistics.n(x, y);
  }
  EXPECT_GT(edge, 1.5 * flat);
}

TEST(GreedyError, SaturatedTargetsHandTheirSamplesOn) {
  const SamplePool pool = test::pool_of(edge_recording(20, 12, 13, false));
  for (const long long budget : {240LL * 8, 240LL * 12 + 11, 240LL * 13 - 1, 240LL * 13}) {
    const auto result = sample_greedy_error(pool, budget, {}, {});
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(test::total(result->selection.statistics.n), budget);
  }
}

void expect_the_error_of_the_twin(int width, int height) {
  const SamplePool pool = test::pool_of(edge_recording(width, height, 9, false));
  CountImage counts(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      counts(x, y) = 4 + (x + 2 * y) % 5;
  }
  PieceStatistics statistics = prefix_statistics(pool, counts);
  GuardCounts guards;
  expose(statistics, pool, guards);
  NlMeansSamplingOptions options;
  options.filter.window = 2;
  options.filter.patch = 1;
  std::array<HalfSums, 2> halves = empty_halves(pool, options);
  CountImage first = counts;  // in two rounds, as a sampler does
  for (std::int32_t& n : first.pixels())
    n = n / 2;
  for (HalfSums& of_half : halves) {
    take_up_to(first, pool, of_half);
    take_up_to(counts, pool, of_half);
  }
  const auto error = nl_means_error(halves, statistics, options, guards);
  ASSERT_TRUE(error.has_value());

  const double e = statistics.signal.exposure;
  HalfImage half[2];
  RgbImage count[2];
  for (int h = 0; h < 2; ++h) {
    CountImage n(width, height);
    PieceStatistics part = empty_statistics(pool.half(h));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int s = h; s < counts(x, y); s += 2)
          take(part, pool.half(h), x, y);
      }
    }
    const auto pieces = estimate_pieces(part, {}, e, guards);
    half[h] = {pieces->mean, pieces->variance};
    count[h] = make_rgb(width, height);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < n.size(); ++i) {
        half[h].mean[c][i] *= e;
        half[h].variance[c][i] =  // by the samples of both halves
            e * e * statistics.m2[c][i] / (statistics.n[i] - 1) / part.n[i];
        count[h][c][i] = part.n[i];
      }
    }
  }
  RgbImage filtered[2], samples[2];
  for (int h = 0; h < 2; ++h) {
    filtered[h] = reference::filter_with_guide(half[h].mean, half[1 - h], options.filter);
    samples[h] = reference::filter_with_guide(count[h], half[1 - h], options.filter);
  }
  for (std::size_t i = 0; i < error->size(); ++i) {
    double expected = 0.0;
    for (int h = 0; h < 2; ++h) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = filtered[0][c][i] - filtered[1][c][i], f = filtered[h][c][i];
        expected += 2 * d * d / (0.1 + f * f) / 3 / samples[h][0][i];
      }
    }
    ASSERT_NEAR((*error)[i], expected, 1e-5 * expected + 1e-6);  // distances and weights are float
  }
}

TEST(NlMeansSampling, ErrorAgreesWithTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    expect_the_error_of_the_twin(width, height);
  }
}

TEST(NlMeansSampling, SpendsTheBudgetWhereTheHalvesDisagree) {
  const SamplePool pool = test::memory_pool(24, 24, 64, [](int x, int y, int s) {
    const auto u = static_cast<float>(unit_double(mix(3, x, y, s)));
    const float value = x < 12 ? 0.8f + 0.01f * u : (u < 0.2f ? 4.0f : 0.1f);
    return Rgb{value, value, value};
  });
  const auto result = sample_nl_means(pool, 24 * 24 * 12 + 5, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 24 * 24 * 12 + 5);
  long long quiet = 0, noisy = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x)
      (x < 12 ? quiet : noisy) += result->selection.statistics.n(x, y);
  }
  EXPECT_GT(noisy, 2 * quiet);
}

void expect_the_density_of_the_twin(int width, int height) {
  const SamplePool pool = test::noisy_pool(width, height, 9);
  CountImage counts(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      counts(x, y) = 4 + (x + 2 * y) % 5;
  }
  PieceStatistics statistics = prefix_statistics(pool, counts);
  GuardCounts guards;
  expose(statistics, pool, guards);
  CrossBilateralSamplingOptions options;
  options.filter.scales = {0, 1, 2};
  const auto density = cross_bilateral_density(statistics, pool, options.filter, guards);
  ASSERT_TRUE(density.has_value());
  const double e = statistics.signal.exposure;
  auto pieces = *estimate_pieces(statistics, {}, e, guards);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      pieces.mean[c][i] *= e;
      pieces.variance[c][i] *= e * e;
    }
  }
  const auto twin = reference::cross_bilateral(pieces.mean, pieces.variance,
                                               reference::features(pool, counts), options.filter);
  const Taps taps = pixel_filter_taps();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t s = 1; s < twin.risk.size(); ++s)
      best = twin.risk[s][i] < twin.risk[best][i] ? s : best;
    double square = 0.0, v = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      square += twin.filtered[best][c][i] * twin.filtered[best][c][i] / 3.0;
      v += truncated_variance(pieces.variance[c], taps, squared_taps(taps))[i] / 3.0;
    }
    const double expected =
        std::max(0.0, twin.risk[best][i] + v) / (square + 0.01) / (1.0 + counts[i]);
    EXPECT_NEAR((*density)[i], expected, 1e-4 * expected + 1e-6);
  }
}

TEST(CrossBilateralSampling, DensityAgreesWithTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    expect_the_density_of_the_twin(width, height);
  }
}

TEST(CrossBilateralSampling, SpendsMoreWhereTheNoiseIs) {
  const SamplePool pool = test::memory_pool(24, 24, 64, [](int x, int y, int s) {
    const auto u = static_cast<float>(unit_double(mix(3, x, y, s)));
    const float value = x < 12 ? 0.8f + 0.01f * u : (u < 0.2f ? 4.0f : 0.1f);
    return Rgb{value, value, value};
  });
  const auto result = sample_cross_bilateral(pool, 24 * 24 * 12 + 5, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 24 * 24 * 12 + 5);
  long long quiet = 0, noisy = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x)
      (x < 12 ? quiet : noisy) += result->selection.statistics.n(x, y);
  }
  EXPECT_GT(noisy, 2 * quiet);
}

// SURE estimates a squared error without bias, so some of its values lie below zero.
TEST(CrossBilateralSampling, WorthsThatComeOutNegativeAreZeroAndCounted) {
  const SamplePool pool = test::memory_pool(32, 32, 8, [](int x, int y, int s) {
    const auto u = static_cast<float>(unit_double(mix(9, x, y, s)));
    return Rgb{0.2f + u * u, 0.2f + u, 0.5f};
  });
  PieceStatistics statistics = prefix_statistics(pool, CountImage(32, 32, 4));
  GuardCounts guards;
  expose(statistics, pool, guards);
  const auto density = cross_bilateral_density(statistics, pool, {}, guards);
  ASSERT_TRUE(density.has_value());
  std::uint64_t zeros = 0;
  for (const double d : density->pixels()) {
    ASSERT_GE(d, 0.0);
    zeros += d == 0.0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 0u);
  EXPECT_EQ(guards[Guard::kNegativeError], zeros);
}

TEST(HandOutDeficits, AWeightThatIsNoNumberCountsAsNone) {
  const SamplePool pool = test::memory_pool(4, 1, 8, [](int, int, int) { return Rgb{1, 1, 1}; });
  Plane weight(4, 1);
  weight[0] = std::numeric_limits<double>::quiet_NaN();
  weight[1] = 1.0;
  weight[2] = -1.0;
  const CountImage more = hand_out_deficits(weight, CountImage(4, 1, 1), pool, 4);
  EXPECT_EQ(std::vector<int>(more.pixels().begin(), more.pixels().end()),
            (std::vector<int>{0, 4, 0, 0}));
}

}  // namespace
}  // namespace spool
