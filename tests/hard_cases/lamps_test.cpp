// Lamps beside dark: what a filter smears of a bright pixel counts there many thousand times. No
// filter that decides anything may be worse than none at all.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kSide = 48, kSpp = 32;

// A share of a pixel's samples sees the lamp, the rest what is behind it, with exponential noise of
// a quarter of its value.
struct Scene {
  double lamp = 0.0;
  double (*share)(int x, int y) = nullptr;
  double (*behind)(int x, int y) = nullptr;

  double mean(int x, int y) const {
    return share(x, y) * lamp + (1.0 - share(x, y)) * behind(x, y);
  }
  Rgb sample(int x, int y, int s) const {
    const double noise = -std::log1p(-unit_double(mix(3, x, y, s)));
    const bool seen = unit_double(mix(4, x, y, s)) < share(x, y);
    const auto v = static_cast<float>(seen ? lamp : behind(x, y) * (0.75 + 0.25 * noise));
    return {v, v, v};
  }
};

// One lamp of radiance 968, smaller than its pixel, before an even wall.
Scene small_lamp() {
  return {968.0, [](int x, int y) { return x == 21 && y == 26 ? 0.6 : 0.0; },
          [](int, int) { return 0.28; }};
}

// A box with a lamp in its ceiling, whose edges lie inside pixels, a floor and a dark block.
Scene lit_room() {
  return {17.0,
          [](int x, int y) {
            const double across = std::clamp(30.3 - x, 0.0, 1.0) * std::clamp(x - 16.4, 0.0, 1.0);
            return across * std::clamp(9.7 - y, 0.0, 1.0) * std::clamp(y - 5.2, 0.0, 1.0);
          },
          [](int x, int y) {
            if (x > 26 && x < 38 && y > 24 && y < 40) return 0.03;
            return y < 14 ? 0.06 : 0.15 + 0.006 * y;
          }};
}

double relative_error(const RgbImage& image, const Scene& scene) {
  double sum = 0.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double truth = scene.mean(x, y), d = image[1](x, y) - truth;
      sum += d * d / (truth * truth + 1e-4);
    }
  }
  return sum / (kSide * kSide);
}

// Fixed kernels, base images of published methods that no pixel can refuse, thresholds that cut the
// ringing of a lamp's wavelets unevenly, variances pooled over a lamp and the dark beside it or
// taken from the few samples of a half, a risk that takes means with a lamp in them for normal.
bool smears(const std::string& label) {
  return label == "gaussian" || label == "greedy_selection" || label == "directional paper" ||
         label == "wavelet_shrinkage" || label == "welch pooled" || label == "nl_means paper" ||
         label == "cross_bilateral cross_nl_means";
}

// Error of every filter over that of no filter.
std::map<std::string, double> ratios_to_no_filter(const Scene& scene) {
  const SamplePool pool = test::memory_pool(
      kSide, kSide, kSpp, [&](int x, int y, int s) { return scene.sample(x, y, s); });
  const Selection selection = test::select_uniform(pool, kSpp);
  RgbImage truth = make_rgb(kSide, kSide);
  for (Plane& channel : truth) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        channel(x, y) = scene.mean(x, y);
    }
  }
  const Reference reference{truth, std::nullopt};
  FilterContext context;
  context.reference = &reference;
  GuardCounts guards;
  const double none = relative_error(pixel_means(selection.statistics, guards), scene);
  std::map<std::string, double> ratios;
  for (const auto& filter : test::every_filter(false)) {
    const auto result = filter.run(selection, pool, context);
    EXPECT_TRUE(result.has_value()) << filter.label();
    ratios[filter.label()] = relative_error(result->image, scene) / none;
  }
  return ratios;
}

TEST(Lamps, NoFilterIsWorseThanNoneAt32Samples) {
  const std::map<std::string, double> small = ratios_to_no_filter(small_lamp());
  const std::map<std::string, double> room = ratios_to_no_filter(lit_room());
  for (const auto& [label, ratio] : small) {
    const double worst = std::max(ratio, room.at(label));
    if (smears(label)) {
      EXPECT_GT(worst, 1.0) << label << " no longer smears: take it off the list";
    } else {
      EXPECT_LE(worst, 1.0001) << label << " " << ratio << " " << room.at(label);
    }
  }
}

}  // namespace
}  // namespace spool
