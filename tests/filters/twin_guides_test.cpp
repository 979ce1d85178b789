// What twin_guides promises: units, black, constants, single bright samples, lamps, few samples.
#include "lib/filters/twin_guides/twin_guides.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/filters/small_pools.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::RadianceFunction;
using testing::select_uniform;

constexpr int kWidth = 40, kHeight = 28;

RgbImage image_of(const SamplePool& pool, int spp, const TwinGuidesOptions& options = {}) {
  const auto result = reconstruct_twin_guides(select_uniform(pool, spp), pool, options, {});
  SPOOL_CHECK(result.has_value());
  return result->image;
}

RgbImage image_of(const RadianceFunction& radiance, int spp = 8) {
  return image_of(make_pool(kWidth, kHeight, 8, radiance), spp);
}

RadianceFunction times(const RadianceFunction& radiance, float factor) {
  return [=](int x, int y, int s) {
    Rgb value = radiance(x, y, s);
    for (float& v : value)
      v *= factor;
    return value;
  };
}

double squared_error(const RgbImage& image, const RgbImage& truth) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i)
      sum += std::pow(image[c][i] - truth[c][i], 2);
  }
  return sum;
}

TEST(TwinGuides, APowerOfTwoScalesEveryBitAndAnyFactorToRounding) {
  const auto picture = noisy_picture(kWidth, kHeight, 2);
  const RgbImage plain = image_of(picture);
  for (const int k : {-20, -3, 1, 20}) {
    const RgbImage image = image_of(times(picture, std::ldexp(1.0f, k)));
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < image[c].size(); ++i)
        ASSERT_EQ(image[c][i], std::ldexp(plain[c][i], k)) << k;
    }
  }
  for (const float factor : {1e-3f, 1e3f}) {
    const RgbImage image = image_of(times(picture, factor));
    for (std::size_t i = 0; i < image[1].size(); ++i)
      ASSERT_NEAR(image[1][i], factor * plain[1][i], 1e-4 * factor);
  }
}

// Stripes of a dark albedo under noisy light.
TEST(TwinGuides, AnEighthOfADarkAlbedoIsTheSameTexture) {
  const auto texture = [](int x, int y) { return (x + y) % 4 < 2 ? 0.05 : 0.25; };
  const auto picture = [=](int x, int y, int s) {
    const auto v =
        static_cast<float>(texture(x, y) * -std::log(1.0 - unit_double(mix(3, x, y, s))));
    return Rgb{v, v, v};
  };
  const auto image_with = [&](double factor) {
    const testing::FeatureFunction features = [=](std::string_view layer, std::size_t, int x, int y,
                                                  int) {
      return layer == "albedo" ? factor * texture(x, y) : 1.0;
    };
    return image_of(make_pool(kWidth, kHeight, 8, picture, {}, {}, features), 8);
  };
  const RgbImage plain = image_with(1.0), dark = image_with(0.125);
  for (std::size_t i = 0; i < plain[1].size(); ++i)
    ASSERT_NEAR(dark[1][i], plain[1][i], 1e-5);
}

TEST(TwinGuides, BlackStaysBlackAndAConstantStaysToTheBit) {
  for (const float value : {0.0f, 0.3f, 1e-20f, 7e9f}) {
    const RgbImage image = image_of([=](int, int, int) { return Rgb{value, value, value}; });
    for (const double v : image[2].pixels())
      ASSERT_EQ(v, static_cast<double>(value));
  }
}

TEST(TwinGuides, OneSampleOfAMillionMovesNoPixelByMuch) {
  const auto picture = noisy_picture(kWidth, kHeight, 4);
  const RgbImage plain = image_of(picture);
  const RgbImage image = image_of([=](int x, int y, int s) {
    return x == 17 && y == 9 && s == 3 ? Rgb{1e6f, 1e6f, 1e6f} : picture(x, y, s);
  });
  double largest = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i)
      largest = std::max(largest, std::abs(image[c][i] - plain[c][i]));
  }
  EXPECT_LT(largest, 0.5);
  EXPECT_GT(largest, 0.0);
}

TEST(TwinGuides, ALampDoesNotShineIntoItsNeighbours) {
  const auto lamp = [](int x, int y, int s) {
    const double noise = 0.8 + 0.4 * unit_double(mix(3, x, y, s));
    const auto value = static_cast<float>(noise * (x == 20 && y >= 10 && y < 14 ? 968.0 : 0.28));
    return Rgb{value, value, value};
  };
  const RgbImage image = image_of(lamp);
  for (int y = 5; y < 20; ++y) {
    for (int x = 14; x < 27; ++x) {
      const bool lit = x == 20 && y >= 10 && y < 14;
      ASSERT_NEAR(image[1](x, y), lit ? 968.0 : 0.28, lit ? 300.0 : 0.1) << x << "," << y;
    }
  }
}

TEST(TwinGuides, WorksWithOneSampleAndWithMoreItErrsLess) {
  const auto picture = noisy_picture(kWidth, kHeight, 6);
  RgbImage truth = make_rgb(kWidth, kHeight);
  const SamplePool pool = make_pool(kWidth, kHeight, 8, picture);
  {
    const SamplePool all = make_pool(kWidth, kHeight, 4096, picture);
    truth = select_uniform(all, 4096).statistics.mean;
  }
  double last = INFINITY;
  for (const int spp : {1, 2, 4, 8}) {
    const double error = squared_error(image_of(pool, spp), truth);
    const double unfiltered = squared_error(select_uniform(pool, spp).statistics.mean, truth);
    EXPECT_LT(error, 0.6 * unfiltered) << spp;
    EXPECT_LT(error, last) << spp;
    last = error;
  }
}

// Error on three scales over that on one, of a picture whose features say nothing.
double gain_of_scales(const std::function<double(int, int)>& truth) {
  const auto samples = [&](int x, int y, int s) {
    const double noise = -std::log(1.0 - unit_double(mix(9, x, y, s)));  // mean 1, variance 1
    const auto value = static_cast<float>(truth(x, y) * noise);
    return Rgb{value, value, value};
  };
  const SamplePool pool =
      make_pool(120, 100, 8, samples, {}, {},
                [](std::string_view, std::size_t, int, int, int) { return 0.5f; });
  RgbImage expected = make_rgb(120, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 120; ++x) {
      for (Plane& channel : expected)
        channel(x, y) = truth(x, y);
    }
  }
  TwinGuidesOptions single;
  single.scales = 1;
  return squared_error(image_of(pool, 8), expected) /
         squared_error(image_of(pool, 8, single), expected);
}

TEST(TwinGuides, CoarserScalesSmoothAWallAndLeaveATexture) {
  EXPECT_LT(gain_of_scales([](int x, int y) { return 1.0 + 0.003 * x + 0.002 * y; }), 0.35);
  EXPECT_LT(gain_of_scales([](int x, int y) { return (x / 6 + y / 6) % 2 == 0 ? 0.2 : 2.0; }),
            1.10);
  EXPECT_LT(gain_of_scales([](int x, int y) { return x < 60 || y % 9 < 4 ? 0.3 : 1.5; }), 1.0);
}

TEST(TwinGuides, LightThatEveryGroupOfSamplesSawReturnsAndThatOfOneDoesNot) {
  const auto rare = [](int x, int y, int s) {  // mean 2: half of the light on one path in 200
    const float value = mix(7, x, y, s) % 200 == 0 ? 201.0f : 1.0f;
    return Rgb{value, value, value};
  };
  const auto first_only = [&](int x, int y, int s) {
    return s % 4 == 0 ? rare(x, y, s) : Rgb{1.0f, 1.0f, 1.0f};
  };
  const auto mean_of = [](const RadianceFunction& radiance, double agreement,
                          double opening = 0.0) {
    TwinGuidesOptions options;
    options.agreement = agreement;
    options.opening = opening;
    const RgbImage image = image_of(make_pool(100, 90, 8, radiance), 8, options);
    double sum = 0.0;
    for (const double v : image[1].pixels())
      sum += v;
    return sum / static_cast<double>(image[1].size());
  };
  EXPECT_LT(mean_of(rare, 0.0), 1.35);
  EXPECT_GT(mean_of(rare, 8.0), 1.5);
  EXPECT_LT(mean_of(rare, 8.0), 2.1);
  EXPECT_EQ(mean_of(first_only, 8.0), mean_of(first_only, 0.0));
  EXPECT_GT(mean_of(rare, 0.0, 8.0), 1.5);  // where tails are heavy hardly any is taken
  EXPECT_EQ(mean_of(first_only, 0.0, 8.0), mean_of(first_only, 0.0));
}

// A lamp out of focus: its disc is bright on one path in twelve, what is around it plain.
TEST(TwinGuides, TheLightOfADiscStaysInIt) {
  const auto distance = [](int x, int y) { return std::hypot(x - 50.0, y - 45.0); };
  const auto lamp = [&](int x, int y, int s) {
    const bool bright = distance(x, y) < 7.0 && mix(9, x, y, s) % 12 == 0;
    const float value = bright ? 60.0f : 0.2f;
    return Rgb{value, value, value};
  };
  const RgbImage image = image_of(make_pool(100, 90, 8, lamp), 8);
  double worst = 0.0, ring = 0.0, disc = 0.0, pieces = 0.0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 100; ++x) {
      if (distance(x, y) > 24.0) worst = std::max(worst, image[1](x, y));
      if (distance(x, y) > 10.0) ring = std::max(ring, image[1](x, y));
      if (distance(x, y) > 7.0) continue;
      disc += image[1](x, y);
      pieces += 1.0;
    }
  }
  EXPECT_LT(worst, 0.21);
  EXPECT_LT(ring, 0.3);  // no glow around it
  EXPECT_GT(disc / pieces, 2.5);  // of 5.2
}

TEST(TwinGuides, FeaturesBeyondFourAreFour) {
  const auto with_albedo = [](float lamp) {
    return make_pool(kWidth, kHeight, 8, noisy_picture(kWidth, kHeight, 5), {}, {},
                     [=](std::string_view layer, std::size_t, int x, int, int s) {
                       return layer == "albedo" && x == 11 && s % 2 == 0 ? lamp : 0.25f;
                     });
  };
  EXPECT_EQ(image_of(with_albedo(4.0f), 8), image_of(with_albedo(1e9f), 8));
  EXPECT_NE(image_of(with_albedo(4.0f), 8), image_of(with_albedo(2.0f), 8));
}

TEST(TwinGuides, AnEmptySelectionIsRefused) {
  const SamplePool pool = make_pool(4, 4, 2, noisy_picture(4, 4, 1));
  const auto result = reconstruct_twin_guides(select_uniform(pool, 0), pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kData);
}

TEST(TwinGuides, RefusesMoreFeatureChannelsThanItFits) {
  RecordedSamples recording = make_pool(3, 3, 2, noisy_picture(3, 3, 1)).recording();
  recording.set_features({{"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "ZW"}},
                         [](const FeatureLayer& layer, const Rectangle& box, int samples) {
                           return Result<std::vector<float>>(std::vector<float>(
                               layer.components.size() * static_cast<std::size_t>(box.area()) *
                                   static_cast<std::size_t>(samples),
                               0.5f));
                         });
  const auto pool =
      SamplePool::create(std::make_shared<const RecordedSamples>(std::move(recording)), {});
  const auto result = reconstruct_twin_guides(select_uniform(*pool, 2), *pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find("8 channels"), std::string::npos);
}

}  // namespace
}  // namespace spool
