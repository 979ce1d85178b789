#include "lib/directions/directional_filter_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "lib/directions/band_angles.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "tests/reference/fourier_wedges.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::max_abs;
using reference::max_difference;
using reference::mirrored_x;
using reference::noise_image;
using reference::transposed;

constexpr SignTaps kTaps[] = {SignTaps::kPkva6, SignTaps::kPkva8, SignTaps::kPkva12};

BankOptions bank(int levels, int dilation = 1) {
  BankOptions options;
  options.levels = levels;
  options.dilation = dilation;
  return options;
}

using Bands = std::function<std::vector<Plane>(const Plane&, const BankOptions&)>;

// The bank of the product, and one that is built on another idea.
const std::pair<const char*, Bands> kBanks[] = {
    {"tree", [](const Plane& image, const BankOptions& o) { return directional_bands(image, o); }},
    {"fourier wedges", [](const Plane& image, const BankOptions& o) {
       return reference::fourier_wedge_bands(image, o.levels, o.extension);
     }}};

Plane sum_of(const std::vector<Plane>& bands) {
  Plane sum(bands[0].width(), bands[0].height());
  for (const Plane& band : bands) {
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += band[i];
  }
  return sum;
}

double energy_of(const Plane& image) {
  double sum = 0.0;
  for (const double value : image.pixels())
    sum += value * value;
  return sum;
}

TEST(DirectionalFilterBank, BandsSumToTheImage) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {9, 2}, {97, 61}}) {
    const Plane image = reference::firefly_image(width, height, 41);
    for (const Extension extension :
         {Extension::kSymmetric, Extension::kClamp, Extension::kPeriodic, Extension::kWhole}) {
      for (const SignTaps taps : kTaps) {
        for (int levels = 0; levels <= 3; ++levels) {
          BankOptions options = bank(levels, levels + 1);
          options.extension = extension;
          options.taps = taps;
          EXPECT_LE(max_difference(sum_of(directional_bands(image, options)), image),
                    4e-15 * max_abs(image));
        }
      }
    }
  }
}

TEST(DirectionalFilterBank, ConstantHasNoDirection) {
  for (int levels = 0; levels <= 3; ++levels) {
    for (const Plane& band : directional_bands(Plane(23, 14, 5.0), bank(levels, 2))) {
      for (const double value : band.pixels())
        EXPECT_EQ(value, 5.0 / (1 << levels));
    }
  }
}

TEST(DirectionalFilterBank, DetailOfAConstantHasNoBand) {
  const Pyramid pyramid = build_pyramid(Plane(40, 30, 8.0), PyramidOptions{});
  for (int k = 0; k < 4; ++k) {
    for (const Plane& band : directional_bands(pyramid.detail[static_cast<std::size_t>(k)],
                                               bank(3, detail_dilation(k)))) {
      EXPECT_EQ(max_abs(band), 0.0);
    }
  }
}

TEST(DirectionalFilterBank, NoLevelsGiveTheImageBack) {
  const Plane image = noise_image(12, 9, 42);
  EXPECT_EQ(directional_bands(image, bank(0)), std::vector<Plane>{image});
  EXPECT_EQ(band_count(bank(0)), 1);
}

// x -> -x sends the wedge at angle th to 180 - th, up to and across the border.
TEST(DirectionalFilterBank, MirroredImageHasMirroredBands) {
  for (const auto& [name, bands_of] : kBanks) {
    const Plane image = noise_image(45, 32, 43);
    for (int levels = 1; levels <= 3; ++levels) {
      const auto bands = bands_of(image, bank(levels, 2));
      const auto of_mirrored = bands_of(mirrored_x(image), bank(levels, 2));
      const auto angles = band_frequency_angles(levels);
      for (std::size_t i = 0; i < bands.size(); ++i) {
        const std::size_t j = levels == 1 ? i : bands.size() - 1 - i;
        EXPECT_NEAR(std::fmod(180.0 - angles[i], 180.0), angles[j], 1e-12);
        EXPECT_LE(max_difference(of_mirrored[i], mirrored_x(bands[j])), 1e-14);
      }
    }
  }
}

TEST(DirectionalFilterBank, TransposedImageHasTransposedBands) {
  for (const auto& [name, bands_of] : kBanks) {
    const Plane image = noise_image(45, 32, 44);
    for (int levels = 1; levels <= 3; ++levels) {
      const auto bands = bands_of(image, bank(levels, 2));
      const auto of_transposed = bands_of(transposed(image), bank(levels, 2));
      const auto angles = band_frequency_angles(levels);
      const std::size_t n = bands.size();
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (n / 2 - 1 + n - i + (levels == 1 ? 1 : 0)) % n;
        EXPECT_NEAR(std::fmod(270.0 - angles[i], 180.0), angles[j], 1e-12);
        EXPECT_LE(max_difference(of_transposed[i], transposed(bands[j])), 1e-14);
      }
    }
  }
}

// A real response means a point-symmetric impulse response.
TEST(DirectionalFilterBank, ResponsesHaveZeroPhase) {
  const int n = 64, c = 32;
  Plane delta(n, n);
  delta(c, c) = 1.0;
  BankOptions options = bank(3);
  options.extension = Extension::kPeriodic;
  for (const Plane& band : directional_bands(delta, options)) {
    for (int y = 1; y < n; ++y) {
      for (int x = 1; x < n; ++x)
        EXPECT_NEAR(band(x, y), band(n - x, n - y), 1e-16);
    }
  }
}

Plane sinusoid(int n, int kx, int ky) {
  Plane image(n, n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      image(x, y) = std::cos(2.0 * std::numbers::pi * (kx * x + ky * y) / n + 0.3);
    }
  }
  return image;
}

// The wedge that holds `angle`, or -1 within `margin` degrees of a border.
int wedge_of(double angle, int levels, double margin) {
  const auto centres = band_frequency_angles(levels);
  const auto borders = band_borders(levels);
  for (const double border : borders) {
    const double distance = std::abs(angle - border);
    if (std::min(distance, 180.0 - distance) < margin) return -1;
  }
  for (std::size_t i = 0; i < borders.size(); ++i) {
    double begin = borders[i], end = borders[(i + 1) % borders.size()], at = angle;
    if (end <= begin) {
      end += 180.0;
      if (at < begin) at += 180.0;
    }
    if (at >= begin && at < end) return static_cast<int>(i);
  }
  return -1;
}

TEST(DirectionalFilterBank, OrientedSinusoidFallsIntoItsWedge) {
  for (const auto& [name, bands_of] : kBanks) {
    for (int levels = 1; levels <= 3; ++levels) {
      int tried = 0;
      const bool is_tree = name == kBanks[0].first;
      const int n = is_tree ? 128 : 64;
      for (int step = 0; step < 90; step += is_tree ? 1 : 5) {
        const double aim = (2.0 * step + 1.0) * std::numbers::pi / 180.0;
        const int kx = static_cast<int>(std::lround(0.225 * std::cos(aim) * n));
        const int ky = static_cast<int>(std::lround(0.225 * std::sin(aim) * n));
        double angle = std::atan2(ky, kx) * 180.0 / std::numbers::pi;
        if (angle >= 180.0) angle -= 180.0;
        const int expected = wedge_of(angle, levels, 4.0);
        if (expected < 0) continue;
        BankOptions options = bank(levels, 1);
        options.extension = Extension::kPeriodic;
        double total = 0.0, best = 0.0;
        int winner = -1, i = 0;
        for (const Plane& band : bands_of(sinusoid(n, kx, ky), options)) {
          const double energy = energy_of(band);
          total += energy;
          if (energy > best) {
            best = energy;
            winner = i;
          }
          ++i;
        }
        EXPECT_EQ(winner, expected) << "l " << levels << " angle " << angle;
        EXPECT_GE(best / total, 0.8) << "l " << levels << " angle " << angle;
        ++tried;
      }
      EXPECT_GE(tried, is_tree ? 55 : 11);
    }
  }
}

TEST(DirectionalFilterBank, AnglesAreThoseOfTheWedgesAndTangentsStandUpright) {
  const double expected[] = {13.2825,  35.7825,  54.2175,  76.7175,
                             103.2825, 125.7825, 144.2175, 166.7175};
  const auto angles = band_frequency_angles(3), tangents = band_tangents(3);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(angles[i], expected[i], 1e-4);
    EXPECT_NEAR(tangents[i], std::fmod(expected[i] + 90.0, 180.0), 1e-4);
  }
  EXPECT_EQ(band_frequency_angles(2), (std::vector<double>{22.5, 67.5, 112.5, 157.5}));
  EXPECT_EQ(band_frequency_angles(1), (std::vector<double>{0.0, 90.0}));
  // A vertical edge varies along x: band H of l = 1, constant along 90 degrees.
  EXPECT_EQ(band_tangents(1)[0], 90.0);
}

// Dilation D is the plain bank on each of the D x D polyphase components.
TEST(DirectionalFilterBank, DilationActsOnPolyphaseComponents) {
  const int d = 4, n = 24;
  const Plane image = noise_image(d * n, d * n, 45);
  BankOptions options = bank(3, d), plain = bank(3, 1);
  options.extension = plain.extension = Extension::kPeriodic;
  const auto bands = directional_bands(image, options);
  Plane component(n, n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x)
      component(x, y) = image(d * x + 1, d * y + 3);
  }
  const auto of_component = directional_bands(component, plain);
  for (std::size_t i = 0; i < 8; ++i) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x)
        ASSERT_EQ(of_component[i](x, y), bands[i](d * x + 1, d * y + 3));
    }
  }
}

TEST(DirectionalFilterBank, ReusedStorageGivesTheSameBands) {
  const Plane image = noise_image(30, 20, 47);
  std::vector<Plane> bands(3, Plane(7, 7, 9.0));
  directional_bands(image, bank(3, 2), bands);
  EXPECT_EQ(bands, directional_bands(image, bank(3, 2)));
}

TEST(DirectionalFilterBank, DetailsAreDilatedByHalfTheirStep) {
  const int expected[] = {1, 1, 2, 4, 8};
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(detail_dilation(k), expected[k]);
}

}  // namespace
}  // namespace spool
