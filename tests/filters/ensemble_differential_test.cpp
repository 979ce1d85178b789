// The weights of an ensemble against what they minimise, on lattices of weights.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "lib/filters/ensemble_weights.h"
#include "tests/reference/ensemble_reference.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::add_noise;
using test::uniform_image;

constexpr int kSteps = 12;

// All weights of `count` parts that are multiples of 1 / kSteps and sum to 1.
void lattice(std::size_t count, int left, std::vector<double>& w,
             std::vector<std::vector<double>>& to) {
  if (w.size() + 1 == count) {
    w.push_back(static_cast<double>(left) / kSteps);
    to.push_back(w);
    w.pop_back();
    return;
  }
  for (int i = 0; i <= left; ++i) {
    w.push_back(static_cast<double>(i) / kSteps);
    lattice(count, left - i, w, to);
    w.pop_back();
  }
}

// Parts with biases and noise of their own, and means with some samples far above the limit: beside
// the light of the others, or in place of some of it (`rare`). Parts that are noise alone make the
// matrix indefinite.
struct Case {
  std::vector<HalfImages> parts;
  HalfImages means;
};

Case case_of(std::size_t count, std::uint64_t seed, bool noise_alone, bool rare) {
  const int width = 23, height = 14;
  const RgbImage truth = uniform_image(width, height, seed, 0.2, 1.5);
  Case made;
  for (std::size_t k = 0; k < count; ++k) {
    RgbImage image = truth;
    for (std::size_t c = 0; c < 3; ++c) {
      for (double& v : image[c].pixels())
        v *= noise_alone ? 0.0 : 0.6 + 0.25 * static_cast<double>(k);
    }
    made.parts.push_back(
        {add_noise(image, 10 * seed + k, 0.2), add_noise(image, 99 * seed + k, 0.2)});
  }
  RgbImage often = truth;
  for (Plane& channel : often) {
    for (double& v : channel.pixels())
      v *= rare ? 0.5 : 1.0;
  }
  made.means = {add_noise(often, seed + 500, 0.5), add_noise(often, seed + 600, 0.5)};
  for (std::size_t h = 0; h < 2; ++h) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 5 + h; p < truth[c].size(); p += rare ? 190 : 37)
        made.means[h][c][p] = 400.0;
    }
  }
  return made;
}

TEST(EnsembleDifferential, NoOtherWeightsHaveLessError) {
  for (const std::size_t count : {2u, 3u, 4u}) {
    for (const int kind : {0, 1, 2}) {
      const Case made = case_of(count, 3 + count, kind == 1, kind == 2);
      const double l = 0.8;
      const std::vector<Plane> weights = cross_fitted_weights(made.parts, made.means, l);
      const reference::EnsembleError error = reference::ensemble_error(made.parts, made.means, l);
      std::vector<std::vector<double>> others;
      std::vector<double> some;
      lattice(count, kSteps, some, others);
      for (std::size_t p = 0; p < weights[0].size(); ++p) {
        std::vector<double> w;
        for (const Plane& of_part : weights)
          w.push_back(of_part[p]);
        const double least = error(w, p);
        for (const std::vector<double>& other : others)
          ASSERT_LE(least, error(other, p) + 1e-9) << count << " parts, pixel " << p;
      }
    }
  }
}

}  // namespace
}  // namespace spool
