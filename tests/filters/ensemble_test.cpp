// The mean of filters, and weights from halves.
#include "lib/filters/ensemble.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::add_noise;
using test::uniform_image;

constexpr int kWidth = 40, kHeight = 33;

HalfImages noisy_halves(const RgbImage& truth, double factor, double noise, std::uint64_t seed) {
  RgbImage scaled = truth;
  for (Plane& channel : scaled) {
    for (double& value : channel.pixels())
      value *= factor;
  }
  return {add_noise(scaled, seed, noise), add_noise(scaled, seed + 1, noise)};
}

void expect_convex(const std::vector<Plane>& weights) {
  for (std::size_t p = 0; p < weights[0].size(); ++p) {
    double sum = 0.0;
    for (const Plane& weight : weights) {
      EXPECT_GE(weight[p], 0.0);
      sum += weight[p];
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

// Parts that have nothing to do with the samples: the matrix is indefinite in many pixels.
TEST(EnsembleWeights, AreConvexWhateverComes) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    std::vector<HalfImages> parts;
    for (std::uint64_t k = 0; k < 4; ++k) {
      parts.push_back({uniform_image(kWidth, kHeight, 10 * seed + k, -1.0, 3.0),
                       uniform_image(kWidth, kHeight, 100 * seed + k, -1.0, 3.0)});
    }
    const HalfImages means = {uniform_image(kWidth, kHeight, seed, 0.0, 4.0),
                              uniform_image(kWidth, kHeight, seed + 7, 0.0, 4.0)};
    expect_convex(cross_fitted_weights(parts, means, 1.0));
  }
}

TEST(EnsembleWeights, PartsThatAreAlikeHaveEqualWeights) {
  const RgbImage truth = uniform_image(kWidth, kHeight, 1, 0.5, 1.5);
  const HalfImages one = noisy_halves(truth, 1.0, 0.1, 2);
  const std::vector<Plane> weights =
      cross_fitted_weights(std::vector{one, one}, noisy_halves(truth, 1.0, 0.3, 4), 1.0);
  expect_convex(weights);
  RgbImage difference = one[0];
  for (std::size_t p = 0; p < weights[0].size(); ++p)
    EXPECT_NEAR(weights[0][p] * one[0][0][p] + weights[1][p] * one[0][0][p], one[0][0][p], 1e-12);
}

TEST(EnsembleWeights, TheHalvesAndTheUnitMayBeExchanged) {
  const RgbImage truth = uniform_image(kWidth, kHeight, 1, 0.5, 1.5);
  std::vector<HalfImages> parts = {noisy_halves(truth, 1.0, 0.2, 2),
                                   noisy_halves(truth, 0.8, 0.1, 4)};
  HalfImages means = noisy_halves(truth, 1.0, 0.4, 6);
  const std::vector<Plane> weights = cross_fitted_weights(parts, means, 1.0);
  std::vector<HalfImages> larger = parts;
  HalfImages larger_means = means;
  for (auto* images : {&larger[0], &larger[1], &larger_means}) {
    for (RgbImage& image : *images) {
      for (Plane& channel : image) {
        for (double& value : channel.pixels())
          value *= 1024.0;
      }
    }
  }
  EXPECT_EQ(cross_fitted_weights(larger, larger_means, 1024.0), weights);
  for (HalfImages& part : parts)
    std::swap(part[0], part[1]);
  std::swap(means[0], means[1]);
  const std::vector<Plane> exchanged = cross_fitted_weights(parts, means, 1.0);
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t p = 0; p < weights[k].size(); ++p)
      EXPECT_NEAR(exchanged[k][p], weights[k][p], 1e-9);
  }
}

double mean_weight(const Plane& weight) {
  double sum = 0.0;
  for (const double w : weight.pixels())
    sum += w / static_cast<double>(weight.size());
  return sum;
}

TEST(EnsembleWeights, TheTruthWithNoiseWeighsMoreThanLightThatIsLost) {
  const RgbImage truth = uniform_image(kWidth, kHeight, 1, 0.9, 1.1);
  const std::vector<HalfImages> parts = {noisy_halves(truth, 1.0, 0.05, 2),
                                         noisy_halves(truth, 0.7, 0.02, 4)};
  const HalfImages means = noisy_halves(truth, 1.0, 0.4, 6);
  EXPECT_GT(mean_weight(cross_fitted_weights(parts, means, 1.0)[0]), 0.8);
}

// A part that copies the samples of its half would win if it were judged by that half; the prior of
// equal weights leaves it about 0.1.
TEST(EnsembleWeights, AHalfIsJudgedByTheOtherHalf) {
  const RgbImage truth = uniform_image(kWidth, kHeight, 1, 0.9, 1.1);
  const HalfImages means = noisy_halves(truth, 1.0, 0.4, 6);
  const std::vector<HalfImages> parts = {means, noisy_halves(truth, 1.0, 0.02, 4)};
  EXPECT_LT(mean_weight(cross_fitted_weights(parts, means, 1.0)[0]), 0.3);
}

TEST(Ensemble, NeedsWhatItsPartsNeedAndHoldsTheirImages) {
  const auto part = [](Needs needs, double memory) {
    const auto run = [](const Selection&, const SamplePool&, const FilterContext&) {
      return Result<Reconstruction>(Reconstruction{});
    };
    return ReadyFilter{run, std::move(needs), {memory, 1e6}};
  };
  const ReadyFilter both = ensemble({part({.features = Use::kWhenRecorded, .signal = false}, 100),
                                     part({.reference = true, .variance = false}, 300)},
                                    {});
  EXPECT_EQ(both.needs.features, Use::kWhenRecorded);
  EXPECT_TRUE(both.needs.reference && both.needs.signal && both.needs.variance && both.needs.pool);
  EXPECT_EQ(both.memory.per_pixel, 300 + 48);
  EXPECT_EQ(both.memory.fixed, 2e6);
}

}  // namespace
}  // namespace spool
