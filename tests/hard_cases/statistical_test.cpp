// Hypothesis tests of everything that claims to be unbiased, and of the one bias that is known.
//
// Seeds are fixed, so a run is repeatable; the significance says how often a right program would
// have failed for another seed: 1e-4 for each TEST, with Sidak's correction over its hypotheses.
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "lib/core/student.h"
#include "lib/experiment/reference.h"
#include "lib/filters/filters.h"
#include "lib/inference/intervals.h"
#include "lib/metrics/error_metrics.h"
#include "lib/statistics/variance_of_mean.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

constexpr double kSignificance = 1e-4;

// Of one hypothesis among `tests` independent ones [Sidak67], two-sided.
double sidak_quantile(int tests, double freedom) {
  const double each = 1.0 - std::pow(1.0 - kSignificance, 1.0 / tests);
  return student_quantile(1.0 - 0.5 * each, freedom);
}

struct Distribution {
  std::string name;
  double mean, variance;
  std::function<double(std::uint64_t seed, std::uint64_t p, std::uint64_t s)> draw;
};

const std::vector<Distribution>& distributions() {
  static const std::vector<Distribution> list = {
      {"uniform", 0.5, 1.0 / 12,
       [](auto seed, auto p, auto s) { return test::uniform(seed, p, s); }},
      {"lognormal", 1.0, std::exp(1.0) - 1.0,
       [](auto seed, auto p, auto s) { return std::exp(test::normal(seed, p, s) - 0.5); }},
      {"bernoulli", 1.0, 19.0,
       [](auto seed, auto p, auto s) { return test::uniform(seed, p, s) < 0.05 ? 20.0 : 0.0; }}};
  return list;
}

SamplePool pool_from(const Distribution& d, std::uint64_t seed, int width, int height, int spp,
                     int holdout = 0) {
  PoolOptions options;
  options.holdout = holdout;
  return test::pool_of(test::memory_recording(width, height, spp,
                                              [&](int x, int y, int s) {
                                                const auto v = static_cast<float>(d.draw(
                                                    seed, static_cast<std::uint64_t>(y * width + x),
                                                    static_cast<std::uint64_t>(s)));
                                                return Rgb{v, v, v};
                                              }),
                       options);
}

// Student's t of the hypothesis that the mean of the values is `expected`.
double t_of(const std::vector<double>& values, double expected) {
  const Interval interval = mean_interval({values});
  return (interval.mean - expected) / interval.standard_error;
}

std::vector<double> as_vector(const Plane& plane) {
  return {plane.pixels().begin(), plane.pixels().end()};
}

TEST(Unbiased, BoxReconstructionForCountsThatDoNotFollowTheSamples) {
  const int side = 160;
  const auto box = make_method(filters(), {"box", "", {}});
  const double bound = sidak_quantile(9, side * side - 1);
  std::uint64_t seed = 100;
  for (const Distribution& d : distributions()) {
    for (const int most : {1, 4, 9}) {
      const SamplePool pool = pool_from(d, ++seed, side, side, 9);
      CountImage n(side, side);
      for (std::size_t p = 0; p < n.size(); ++p)
        n[p] = 1 + static_cast<int>(mix(seed, p, 1) % static_cast<std::uint64_t>(most));
      const auto result = (*box)(Selection{prefix_statistics(pool, n), {}}, pool, FilterContext{});
      ASSERT_TRUE(result.has_value());
      EXPECT_LT(std::abs(t_of(as_vector(result->image[1]), d.mean)), bound)
          << d.name << " up to " << most;
    }
  }
}

TEST(Unbiased, RawVarianceOfTheMean) {
  const int side = 160;
  const double bound = sidak_quantile(9, side * side - 1);
  std::uint64_t seed = 200;
  for (const Distribution& d : distributions()) {
    for (const int n : {2, 3, 8}) {
      const SamplePool pool = pool_from(d, ++seed, side, side, n);
      const PieceStatistics s = test::select_uniform(pool, n).statistics;
      GuardCounts guards;
      VarianceOptions options;
      options.mode = VarianceMode::kRaw;
      const Plane v = variance_of_mean(s.n, s.mean[0], s.m2[0], options, guards);
      EXPECT_LT(std::abs(t_of(as_vector(v), d.variance / n)), bound) << d.name << " " << n;
    }
  }
}

// Neighbours share a pooled variance, so whole images are the independent values.
TEST(Unbiased, PooledVarianceOfTheMeanOfAFlatImage) {
  const int side = 10, images = 400;
  const double bound = sidak_quantile(9, images - 1);
  std::uint64_t seed = 300;
  for (const Distribution& d : distributions()) {
    for (const int n : {1, 2, 3}) {
      std::vector<double> means;
      for (int i = 0; i < images; ++i) {
        const SamplePool pool = pool_from(d, ++seed, side, side, n);
        const PieceStatistics s = test::select_uniform(pool, n).statistics;
        GuardCounts guards;
        VarianceOptions options;
        options.mode = VarianceMode::kPooled;
        const Plane v = variance_of_mean(s.n, s.mean[0], s.m2[0], options, guards);
        means.push_back(std::accumulate(v.pixels().begin(), v.pixels().end(), 0.0) / (side * side));
      }
      EXPECT_LT(std::abs(t_of(means, d.variance / n)), bound) << d.name << " " << n;
    }
  }
}

// (n - 1) s^2 / sigma^2 of normal samples, summed over N pixels, is chi-square with N (n - 1)
// degrees of freedom; its cube root is normal to good accuracy [WilsonHilferty31].
TEST(Unbiased, SumsOfSquaresOfNormalSamplesAreChiSquare) {
  const int side = 96;
  const double bound = sidak_quantile(4, 1e9);
  for (const int n : {2, 3, 5, 16}) {
    const SamplePool pool = test::memory_pool(side, side, n, [&](int x, int y, int s) {
      const auto v =
          static_cast<float>(3.0 + 0.5 * test::normal(400 + static_cast<std::uint64_t>(n),
                                                      static_cast<std::uint64_t>(y * side + x),
                                                      static_cast<std::uint64_t>(s)));
      return Rgb{v, v, v};
    });
    const PieceStatistics s = test::select_uniform(pool, n).statistics;
    const double freedom = side * side * (n - 1.0);
    const double chi =
        std::accumulate(s.m2[2].pixels().begin(), s.m2[2].pixels().end(), 0.0) / 0.25;
    const double z = (std::cbrt(chi / freedom) - (1.0 - 2.0 / (9.0 * freedom))) /
                     std::sqrt(2.0 / (9.0 * freedom));
    EXPECT_LT(std::abs(z), bound) << n;
  }
}

struct Replicates {
  std::vector<double> wald;    // sum over pixels of (sum of samples taken - n mu)
  std::vector<double> excess;  // debiased mse against held-out samples minus the true mse
};

// `sampler` on small images of d, none of which shares a sample with another.
Replicates replicate(const test::NamedMethod<SamplerFunction>& sampler, const Distribution& d,
                     int images, std::uint64_t seed) {
  const int side = 10, spp = 28, holdout = 8;
  Replicates found;
  MetricOptions quick;
  quick.perceptual = Perceptual::kNone;
  quick.bootstrap.resamples = 2;
  for (int i = 0; i < images; ++i) {
    const SamplePool pool = pool_from(d, mix(seed, i), side, side, spp, holdout);
    const auto sampled =
        sampler.run(pool, side * side * 7, test::sampling_context(mix(seed, i, 1)));
    if (!sampled.has_value()) {
      ADD_FAILURE() << sampler.label() << ": " << sampled.error().message;
      return found;
    }
    const PieceStatistics& s = sampled->selection.statistics;
    double surplus = 0.0;
    for (std::size_t p = 0; p < s.n.size(); ++p)
      surplus += s.n[p] * (s.mean[0][p] - d.mean);
    found.wald.push_back(surplus);
    GuardCounts guards;
    const RgbImage estimate = pixel_means(s, guards);
    auto held_out = holdout_reference(pool);
    SPOOL_CHECK(held_out.has_value());
    const auto mse = [&](const JudgingReference& reference) {
      return error_metrics(estimate, reference, quick)["mse"].value;
    };
    found.excess.push_back(mse(*held_out) - mse({make_rgb(side, side, d.mean), {}, {}}));
  }
  return found;
}

int images_to_replicate() {
  return test::whole_hard_cases() ? 1000 : 60;
}

// However the samples were chosen, decisions that looked behind the cursor only leave
// E[sum of taken samples - n mu] = 0 [Wald45]. An oracle is found out.
TEST(Wald, SamplesTakenAreFairForEverySamplerAndNotForTheOracle) {
  const auto samplers = test::every_sampler();
  const int images = images_to_replicate();
  const double bound =
      sidak_quantile(static_cast<int>(samplers.size() * distributions().size()), images - 1);
  for (const auto& sampler : samplers) {
    for (const Distribution& d : distributions()) {
      const double t = t_of(replicate(sampler, d, images, 500).wald, 0.0);
      if (sampler.name == "neyman" && d.name != "uniform") {
        EXPECT_GT(t, bound) << "neyman looks at everything: " << d.name;
      } else if (sampler.name != "neyman") {
        EXPECT_LT(std::abs(t), bound) << sampler.label() << ", " << d.name;
      }
    }
  }
}

TEST(Unbiased, DebiasedErrorAgainstHeldOutSamplesForEverySampler) {
  const auto samplers = test::every_sampler();
  const int images = images_to_replicate();
  const double bound =
      sidak_quantile(static_cast<int>(samplers.size() * distributions().size()), images - 1);
  for (const auto& sampler : samplers) {
    for (const Distribution& d : distributions()) {
      const double t = t_of(replicate(sampler, d, images, 600).excess, 0.0);
      EXPECT_LT(std::abs(t), bound) << sampler.label() << ", " << d.name;
    }
  }
}

// Two stages: n0 samples, then n1 - n0 more where their contrast is above one half. The bias that
// the decision makes is -(1 - n0 / n1) Cov(1_S, M0): +5.2 %, -3.3 % and -71 % of the mean.
TEST(AdaptiveBias, IsWhatTheFormulaSays) {
  constexpr int kFirst = 4, kAll = 32;
  constexpr double kShare = 1.0 - static_cast<double>(kFirst) / kAll;
  const int trials = test::whole_hard_cases() ? 1'000'000 : 60'000;
  const double expected_percent[] = {5.2, -3.3, -71.0};
  const double bound = sidak_quantile(6, trials - 1);
  for (std::size_t k = 0; k < distributions().size(); ++k) {
    const Distribution& d = distributions()[k];
    std::vector<double> bias, residual, first_means, chosen;
    const auto cells = static_cast<int>(std::ceil(std::sqrt(trials)));
    const SamplePool pool = pool_from(d, 700 + k, cells, cells, kAll);
    const PieceStatistics first = test::select_uniform(pool, kFirst).statistics;
    CountImage n(cells, cells, kFirst);
    for (std::size_t p = 0; p < n.size(); ++p) {
      const double low = first.analysis.minimum[p], high = first.analysis.maximum[p];
      if (high - low > 0.5 * (high + low)) n[p] = kAll;
    }
    const PieceStatistics both = prefix_statistics(pool, n);
    double p_chosen = 0.0;
    for (const auto count : n.pixels())
      p_chosen += count == kAll ? 1.0 / static_cast<double>(n.size()) : 0.0;
    for (std::size_t p = 0; p < n.size(); ++p) {
      bias.push_back(both.mean[0][p] - d.mean);
      const double s = n[p] == kAll ? 1.0 : 0.0;
      residual.push_back(bias.back() + kShare * (s - p_chosen) * (first.mean[0][p] - d.mean));
    }
    EXPECT_LT(std::abs(t_of(residual, 0.0)), bound) << d.name;
    const Interval found = mean_interval({bias});
    // The figure is known to its last printed digit.
    const double rounding = 0.01 * d.mean * (k == 2 ? 0.5 : 0.05);
    EXPECT_NEAR(found.mean, 0.01 * expected_percent[k] * d.mean,
                rounding + bound * found.standard_error)
        << d.name;
    EXPECT_GT(std::abs(t_of(bias, 0.0)), bound) << d.name << ": the bias is there";
  }
}

}  // namespace
}  // namespace spool
