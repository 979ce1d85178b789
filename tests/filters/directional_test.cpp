#include "lib/filters/directional/directional.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/directions/band_angles.h"
#include "lib/filters/box.h"
#include "lib/filters/directional/tile.h"
#include "lib/filters/filters.h"
#include "tests/filters/directional_cases.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using testing::constant_widths;
using testing::filter_pieces;
using testing::make_pool;
using testing::noisy_picture;
using testing::random_filter_case;
using testing::random_widths;
using testing::select_counts;
using testing::select_uniform;

Reconstruction run(const Selection& selection, const SamplePool& pool,
                   const DirectionalOptions& options = {}, Views* views = nullptr) {
  FilterContext context;
  context.views = views;
  auto result = reconstruct_directional(selection, pool, options, context);
  EXPECT_TRUE(result.has_value());
  return std::move(*result);
}

std::vector<DirectionalOptions> variants() {
  std::vector<DirectionalOptions> all = {robust_directional_options(), paper_directional_options()};
  DirectionalOptions old = robust_directional_options();
  old.base = BaseImage::kNone;
  old.size.smooth = SizeSmooth::kOn;
  old.size.factor.rule = SizeFactorRule::kLiteralClamped;
  old.filter.weighting = FilterWeighting::kPerSample;
  all.push_back(old);
  DirectionalOptions bank = robust_directional_options();
  bank.width.anisotropy = AnisotropySource::kFilterBank;
  all.push_back(bank);
  DirectionalOptions round = robust_directional_options();
  round.width.anisotropy = AnisotropySource::kNone;
  all.push_back(round);
  DirectionalOptions halves = robust_directional_options();
  halves.decide = Deciding::kHalves;
  all.push_back(halves);
  return all;
}

double ulps_apart(double a, double b) {
  const double ulp = std::nextafter(std::abs(b), INFINITY) - std::abs(b);
  return std::abs(a - b) / ulp;
}

TEST(Directional, ConstantsArePreservedTo4Ulp) {
  const SamplePool pool =
      make_pool(37, 29, 6, [](int, int, int) { return Rgb{0.1f, 0.7f, 1234.5f}; });
  const Selection selection =
      select_counts(pool, [](int x, int y) { return 1 + (x * 7 + y * 3) % 6; });
  for (const DirectionalOptions& options : variants()) {
    const Reconstruction result = run(selection, pool, options);
    for (const double v : result.image[0].pixels())
      ASSERT_LE(ulps_apart(v, static_cast<double>(0.1f)), 4.0);
    for (const double v : result.image[1].pixels())
      ASSERT_LE(ulps_apart(v, static_cast<double>(0.7f)), 4.0);
    for (const double v : result.image[2].pixels())
      ASSERT_LE(ulps_apart(v, 1234.5), 4.0);
  }
}

TEST(Directional, AllBlackStaysBlack) {
  const SamplePool pool = make_pool(20, 20, 4, [](int, int, int) { return Rgb{}; });
  for (const DirectionalOptions& options : variants()) {
    const Reconstruction result = run(select_uniform(pool, 3), pool, options);
    for (const double v : result.image[1].pixels())
      ASSERT_EQ(v, 0.0);
    const unsigned decisions = options.decide == Deciding::kHalves ? 2 : 1;
    EXPECT_EQ(result.guards[Guard::kExposureFallback], options.normalise_exposure ? decisions : 0u);
  }
}

// Weights are >= 0 and sum to one: every value lies between the extremes of its inputs.
TEST(AnisotropicFilter, OutputLiesBetweenTheExtremesOfTheInput) {
  auto c = random_filter_case(40, 31, 3);
  const auto widths = random_widths<float>(c.level, 3, 4);
  GuardCounts guards;
  const auto out = filter_pieces(c.input(), widths, {}, guards);
  for (const double v : out.image[0].pixels()) {
    EXPECT_GE(v, 0.0);
    EXPECT_LE(v, 1.0);
  }
}

TEST(AnisotropicFilter, LinearInTheImage) {
  auto a = random_filter_case(33, 21, 5), b = random_filter_case(33, 21, 5);
  for (std::size_t i = 0; i < b.mean[0].size(); ++i)
    b.mean[0][i] = testing::random_unit(6, 6, i);
  auto sum = a;
  for (std::size_t i = 0; i < b.mean[0].size(); ++i)
    sum.mean[0][i] = 2.0 * a.mean[0][i] + 3.0 * b.mean[0][i];
  const auto widths = random_widths<double>(a.level, 3, 7);
  GuardCounts guards;
  const auto fa = filter_pieces(a.input(), widths, {}, guards);
  const auto fb = filter_pieces(b.input(), widths, {}, guards);
  const auto fs = filter_pieces(sum.input(), widths, {}, guards);
  for (std::size_t i = 0; i < b.mean[0].size(); ++i)
    EXPECT_NEAR(fs.image[0][i], 2.0 * fa.image[0][i] + 3.0 * fb.image[0][i], 1e-13);
}

TEST(AnisotropicFilter, ARampIsKeptInTheInterior) {
  auto c = random_filter_case(50, 44, 8);
  c.n = CountImage(50, 44, 3);
  for (int y = 0; y < 44; ++y) {
    for (int x = 0; x < 50; ++x)
      c.mean[1](x, y) = 0.3 * x - 0.2 * y + 5.0;
  }
  const auto widths = random_widths<double>(c.level, 3, 9);
  GuardCounts guards;
  const auto out = filter_pieces(c.input(), widths, {}, guards);
  for (int y = 8; y < 36; ++y) {
    for (int x = 8; x < 42; ++x)
      EXPECT_NEAR(out.image[1](x, y), c.mean[1](x, y), 1e-12);
  }
}

TEST(AnisotropicFilter, MirroringAndTransposingMapTheAngles) {
  const auto c = random_filter_case(23, 17, 10);
  const auto widths = random_widths<double>(c.level, 3, 11);
  GuardCounts guards;
  const auto out = filter_pieces(c.input(), widths, {}, guards);
  const auto check = [&](auto&& move, auto&& map_angle) {
    auto moved = c;
    moved.n = move(c.n);
    moved.level = move(c.level);
    for (std::size_t i = 0; i < 3; ++i) {
      moved.mean[i] = move(c.mean[i]);
      moved.variance[i] = move(c.variance[i]);
    }
    std::vector<std::pair<double, Plane>> directions;
    for (std::size_t i = 0; i < widths.beta.size(); ++i)
      directions.emplace_back(map_angle(widths.beta[i]), move(widths.delta[i]));
    std::sort(directions.begin(), directions.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    FilterWidths<double> moved_widths;
    for (auto& [beta, delta] : directions) {
      moved_widths.beta.push_back(beta);
      moved_widths.delta.push_back(std::move(delta));
    }
    const auto moved_out = filter_pieces(moved.input(), moved_widths, {}, guards);
    EXPECT_LT(reference::max_difference(moved_out.image[0], move(out.image[0])), 1e-13);
  };
  check([](const auto& image) { return reference::mirrored_x(image); },
        [](double b) { return std::fmod(180.0 - b, 180.0); });
  check([](const auto& image) { return reference::transposed(image); },
        [](double b) { return std::fmod(270.0 - b, 180.0); });
}

TEST(AnisotropicFilter, StripesSurviveAFilterAlongThemAndNotOneAcross) {
  auto c = random_filter_case(41, 41, 12);
  c.n = CountImage(41, 41, 1);
  c.level = CountImage(41, 41, 4);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 41; ++x)
      c.mean[0](x, y) = x / 3 % 2;  // constant along 90 degrees
  }
  const std::vector<double> beta = {0.0, 30.0, 60.0, 90.0, 120.0, 150.0};
  const auto error = [&](const std::vector<double>& delta) {
    GuardCounts guards;
    const auto out =
        filter_pieces(c.input(), constant_widths<double>(c.level, beta, delta), {}, guards);
    double sum = 0.0;
    for (int x = 10; x < 31; ++x)
      sum += std::abs(out.image[0](x, 20) - c.mean[0](x, 20)) / 21;
    return sum;
  };
  const double along = error({0.25, 0.25, 0.25, 6.0, 0.25, 0.25});
  const double across = error({6.0, 0.25, 0.25, 0.25, 0.25, 0.25});
  EXPECT_LT(along, 0.2);
  EXPECT_GT(across, 0.4);
}

TEST(AnisotropicFilter, EmptySurroundingsLeaveTheFilledMean) {
  auto c = random_filter_case(30, 30, 13);
  c.n = CountImage(30, 30, 0);
  c.n(29, 29) = 1;
  c.level = CountImage(30, 30, 1);
  const auto widths = constant_widths<float>(c.level, {0.0}, {0.8});
  GuardCounts guards;
  const auto out = filter_pieces(c.input(), widths, {}, guards);
  EXPECT_EQ(out.image[0](3, 3), c.mean[0](3, 3));
  EXPECT_GT(guards[Guard::kZeroWeight], 800u);
}

// Tangent, not normal: a vertical edge is averaged along 90 degrees.
TEST(Directional, AVerticalEdgeIsWidestAt90Degrees) {
  const int size = 64;
  const SamplePool pool = make_pool(size, size, 4, [&](int x, int y, int s) {
    const double noise = 0.02 * (unit_double(mix(1, x, y, s)) - 0.5);
    const auto v = static_cast<float>((x < size / 2 ? 0.2 : 1.0) + noise);
    return Rgb{v, v, v};
  });
  DirectionalOptions options;
  options.size.factor.constant = 0.0;  // never stops: a filter everywhere
  options.size.evidence = 0.0;
  const Reconstruction result = run(select_uniform(pool, 4), pool, options);
  const std::vector<double> beta = band_tangents(3);
  for (int y = 16; y < 48; ++y) {
    const double direction = (*result.dominant_direction)(size / 2, y);
    EXPECT_LT(std::abs(direction - 90.0), 20.0) << direction;
  }
  // The wrong choice blurs the edge.
  const auto error = [&](FilterAngle angle) {
    options.width.angle = angle;
    const Reconstruction filtered = run(select_uniform(pool, 4), pool, options);
    double sum = 0.0;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x)
        sum += std::pow(filtered.image[0](x, y) - (x < size / 2 ? 0.2 : 1.0), 2);
    }
    return sum;
  };
  EXPECT_GT(error(FilterAngle::kNormal), 1.5 * error(FilterAngle::kTangent));
}

TEST(Directional, ExposureByAPowerOfTwoScalesExactly) {
  const auto picture = noisy_picture(41, 33, 6);
  const SamplePool pool = make_pool(41, 33, 4, picture);
  for (DirectionalOptions options : variants()) {
    options.normalise_exposure = true;
    for (const double factor : {0x1p-20, 0x1p20}) {
      const SamplePool scaled = make_pool(41, 33, 4, [&](int x, int y, int s) {
        Rgb value = picture(x, y, s);
        for (float& v : value)
          v *= static_cast<float>(factor);
        return value;
      });
      const Reconstruction a = run(select_uniform(pool, 3), pool, options);
      const Reconstruction b = run(select_uniform(scaled, 3), scaled, options);
      EXPECT_EQ(*a.level, *b.level);
      for (std::size_t i = 0; i < a.image[0].size(); ++i) {
        ASSERT_EQ(a.image[0][i] * factor, b.image[0][i]);
        ASSERT_EQ((*a.variance)[2][i] * factor * factor, (*b.variance)[2][i]);
      }
    }
  }
}

TEST(Directional, OneSampleEverywhereReconstructs) {
  const SamplePool pool = make_pool(48, 32, 1, noisy_picture(48, 32, 7));
  for (const DirectionalOptions& options : variants()) {
    const Reconstruction result = run(select_uniform(pool, 1), pool, options);
    for (const double v : result.image[0].pixels())
      ASSERT_TRUE(std::isfinite(v));
  }
}

// Red left, green right, of equal luminance; a little noise.
SamplePool equal_luminance() {
  return testing::make_pool(48, 32, 8, [](int x, int y, int s) {
    const double noise = 0.9 + 0.2 * unit_double(mix(3, x, y, s));
    if (x < 24) return Rgb{static_cast<float>(noise / 0.2126), 0.0f, 0.0f};
    return Rgb{0.0f, static_cast<float>(noise / 0.7152), 0.0f};
  });
}

TEST(Directional, AnEdgeOfColourAloneIsSeenByTheChannels) {
  const SamplePool pool = equal_luminance();
  const Selection selection = testing::select_uniform(pool, 8);
  const auto by = [&](const char* channel) {
    const auto filter =
        *make_method(filters(), {"directional", "", {{"analysis_channel", channel}}});
    return *filter(selection, pool, FilterContext{});
  };
  const Reconstruction luminance = by("luminance"), channels = by("per_channel");
  EXPECT_EQ(luminance.image, by("of_selection").image);
  EXPECT_GE((*luminance.level)(23, 16), 3);
  EXPECT_LE((*channels.level)(23, 16), 1);
  EXPECT_LE((*by("max_rgb").level)(23, 16), 1);
  EXPECT_GE((*channels.level)(6, 16), 3);  // away from the edge all agree
  EXPECT_GT(luminance.image[1](20, 16), 20 * channels.image[1](20, 16));  // green bleeds into red
}

TEST(Directional, GreySamplesHaveTheSizesOfLuminanceInEveryChannel) {
  const SamplePool pool = testing::make_pool(33, 29, 8, [](int x, int y, int s) {
    const auto v = static_cast<float>((x + y > 30 ? 1.0 : 0.3) * unit_double(mix(5, x, y, s)));
    return Rgb{v, v, v};
  });
  const Selection selection = testing::select_uniform(pool, 6);
  for (const char* preset : {"robust", "paper"}) {
    const auto luminance = *make_method(filters(), {"directional", preset, {}});
    const auto channels =
        *make_method(filters(), {"directional", preset, {{"analysis_channel", "per_channel"}}});
    const Reconstruction a = *luminance(selection, pool, FilterContext{}),
                         b = *channels(selection, pool, FilterContext{});
    std::size_t differ = 0;
    for (std::size_t i = 0; i < a.level->size(); ++i)
      differ += (*a.level)[i] != (*b.level)[i];
    EXPECT_LE(differ, 2u) << preset;  // T that rounding decides
  }
}

TEST(Directional, AFireflyIsSpreadAndCannotBreakTheImage) {
  const SamplePool pool = make_pool(40, 40, 4, [](int x, int y, int s) {
    const auto v = static_cast<float>(0.5 + 0.2 * (unit_double(mix(5, x, y, s)) - 0.5));
    return x == 20 && y == 20 && s == 1 ? Rgb{1e6f, 1e6f, 1e6f} : Rgb{v, v, v};
  });
  for (const DirectionalOptions& options : variants()) {
    const Reconstruction result = run(select_uniform(pool, 4), pool, options);
    for (const double v : result.image[0].pixels()) {
      ASSERT_TRUE(std::isfinite(v));
      ASSERT_GE(v, 0.0);
      ASSERT_LE(v, 0.25e6 + 1.0);
    }
    EXPECT_NEAR(result.image[0](2, 2), 0.5, 0.15);
  }
  const Reconstruction robust = run(select_uniform(pool, 4), pool);
  EXPECT_GT((*robust.level)(20, 20), 0);
}

TEST(Directional, EnormousFirefliesStayFiniteInFloat) {
  const SamplePool pool = make_pool(24, 24, 4, [](int x, int y, int) {
    return x == 12 && y == 12 ? Rgb{1e15f, 1e15f, 1e15f} : Rgb{1e-6f, 1e-6f, 1e-6f};
  });
  const Reconstruction result = run(select_uniform(pool, 4), pool);
  for (const double v : result.image[0].pixels())
    ASSERT_TRUE(std::isfinite(v));
}

TEST(Directional, CentresWithoutSamplesAreFilled) {
  const SamplePool pool = make_pool(32, 32, 8, noisy_picture(32, 32, 8));
  const Selection selection =
      select_counts(pool, [](int x, int y) { return (x + y) % 3 == 0 ? 8 : 0; });
  for (const DirectionalOptions& options : variants()) {
    const Reconstruction result = run(selection, pool, options);
    for (const double v : result.image[1].pixels()) {
      ASSERT_TRUE(std::isfinite(v));
      ASSERT_GT(v, 0.05);
    }
    EXPECT_GT(result.guards[Guard::kEmptyPiece], 600u);
  }
}

// As many positions, the same number in each quarter of the pixel.
std::vector<FilmPosition> quarters(int samples) {
  std::vector<FilmPosition> film;
  for (int s = 0; s < samples; ++s)
    film.push_back(
        {0.25f + 0.5f * static_cast<float>(s % 2), 0.25f + 0.5f * static_cast<float>(s / 2 % 2)});
  return film;
}

TEST(Directional, QuarterPixelsThatKeepTheirMeansAreIndependent) {
  const SamplePool pool =
      make_pool(20, 14, 16, noisy_picture(20, 14, 9), {.pieces_per_side = 2}, quarters(16));
  DirectionalOptions options;
  options.base = BaseImage::kNone;
  options.size.factor.constant = 1e9;  // stops at once
  const Selection selection = select_uniform(pool, 4);
  const Reconstruction own = run(selection, pool, options);
  const auto box = reconstruct_box(selection, pool, {}, {});
  int stopped = 0;
  for (std::size_t p = 0; p < own.image[1].size(); ++p) {
    const int x = 2 * static_cast<int>(p % 20), y = 2 * static_cast<int>(p / 20);
    if ((*own.level)(x, y) + (*own.level)(x + 1, y) + (*own.level)(x, y + 1) +
            (*own.level)(x + 1, y + 1) >
        0)
      continue;
    ++stopped;
    EXPECT_DOUBLE_EQ((*own.variance)[1][p], (*box->variance)[1][p]);
  }
  EXPECT_GT(stopped, 20);
}

TEST(Directional, QuarterPixelsAreAveragedAfterFiltering) {
  const SamplePool pool =
      make_pool(20, 14, 16, noisy_picture(20, 14, 9), {.pieces_per_side = 2}, quarters(16));
  const Reconstruction result = run(select_uniform(pool, 4), pool);
  EXPECT_EQ(result.image[0].width(), 20);
  EXPECT_EQ(result.image[0].height(), 14);
  EXPECT_EQ(result.level->width(), 40);
}

TEST(Directional, SamplesAtPieceCentresGiveThePieceFilter) {
  const SamplePool pool = make_pool(25, 19, 6, noisy_picture(25, 19, 10), {},
                                    std::vector<FilmPosition>(6, FilmPosition{0.5f, 0.5f}));
  const Selection selection = select_counts(pool, [](int x, int y) { return 2 + (x * y) % 5; });
  DirectionalOptions options = paper_directional_options();
  const Reconstruction samples = run(selection, pool, options);
  options.filter.granularity = FilterGranularity::kPiece;
  const Reconstruction pieces = run(selection, pool, options);
  EXPECT_LT(reference::max_difference(samples.image[0], pieces.image[0]), 1e-12);
}

TEST(Directional, OneTileIsTheGlobalReconstruction) {
  const SamplePool pool = make_pool(50, 45, 4, noisy_picture(50, 45, 11));
  DirectionalOptions options;
  const Reconstruction global = run(select_uniform(pool, 4), pool, options);
  options.scope = ReconstructionScope::kTile;
  options.tile = 64;
  const Reconstruction tiled = run(select_uniform(pool, 4), pool, options);
  EXPECT_EQ(global.image, tiled.image);
  EXPECT_EQ(*global.level, *tiled.level);
}

TEST(Directional, TilesCoverTheImageOnceAndMergeNarrowEnds) {
  for (const auto& [width, height] : {std::pair{1, 1}, {64, 64}, {70, 130}, {80, 79}, {200, 15}}) {
    const auto tiles = cut_tiles({0, 0, width, height}, 64, 16);
    CountImage covered(width, height);
    for (const Rectangle& t : tiles) {
      EXPECT_TRUE(t.width() >= std::min(16, width) && t.height() >= std::min(16, height));
      for (int y = t.y0; y < t.y1; ++y) {
        for (int x = t.x0; x < t.x1; ++x)
          ++covered(x, y);
      }
    }
    for (const int times : covered.pixels())
      EXPECT_EQ(times, 1);
  }
}

TEST(Directional, TiledViewsAreJoined) {
  const SamplePool pool = make_pool(40, 40, 4, noisy_picture(40, 40, 12));
  DirectionalOptions options;
  options.scope = ReconstructionScope::kTile;
  options.tile = 20;
  Views views({"level", "stop", "f.2"});
  const Reconstruction result = run(select_uniform(pool, 4), pool, options, &views);
  ASSERT_EQ(views.collected().size(), 7u);  // stop.base, too
  for (const View& view : views.collected()) {
    ASSERT_EQ(view.image.width(), 40);
    if (view.name != "level") continue;
    for (std::size_t i = 0; i < view.image.size(); ++i)
      EXPECT_EQ(view.image[i], (*result.level)[i]);
  }
}

TEST(Directional, AttenuationOfAnotherSizeIsAnErrorThatSaysBothSizes) {
  const SamplePool pool = make_pool(8, 6, 4, noisy_picture(8, 6, 13));
  Selection selection = select_uniform(pool, 2);
  selection.attenuation.assign(5, Plane(4, 4, 1.0));
  const auto result = reconstruct_directional(selection, pool, {}, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().message.find("4 x 4"), std::string::npos);
  EXPECT_NE(result.error().message.find("8 x 6"), std::string::npos);
}

// A wrong output variance is easy to write: hold it to the spread over independent noise images,
// for a fixed filter. Neighbours share their noise over some 60 pieces, so 120 images x 400 pieces
// are about 800 independent variances: the ratio's own deviation is near sqrt(2 / 800) = 0.05.
TEST(DirectionalHalves, NoSampleDecidesAboutItself) {
  DirectionalOptions options;
  options.decide = Deciding::kHalves;
  // Level and direction are those of the even samples' image: decided by the odd ones.
  const auto level = [&](int changed) {
    const auto picture = noisy_picture(32, 24, 5);
    const SamplePool pool = make_pool(32, 24, 8, [=](int x, int y, int s) {
      Rgb value = picture(x, y, s);
      if (s % 2 == changed && x > 8) value[1] *= 3.0f * static_cast<float>(x % 3);
      return value;
    });
    return *run(select_uniform(pool, 8), pool, options).level;
  };
  const CountImage unchanged = level(2);
  EXPECT_EQ(level(0), unchanged);
  EXPECT_NE(level(1), unchanged);
}

TEST(DirectionalHalves, EqualHalvesAreOneHalfThatDecidesAboutItself) {
  const auto picture = noisy_picture(33, 21, 6);
  const SamplePool pool =
      make_pool(33, 21, 8, [=](int x, int y, int s) { return picture(x, y, s / 2); });
  DirectionalOptions options;
  const Reconstruction own = run(select_uniform(pool.half(0), 4), pool.half(0), options);
  options.decide = Deciding::kHalves;
  const Reconstruction halves = run(select_uniform(pool, 8), pool, options);
  EXPECT_EQ(halves.image, own.image);
  EXPECT_EQ(halves.level, own.level);
}

// Rare bright samples, everywhere alike, of mean 1: a filter that decides by what it averages
// stops where there is light.
TEST(DirectionalHalves, KeepTheLightThatAllSamplesAboutAllLose) {
  constexpr int kSide = 64, kRuns = 8, kSamples = 8;
  const auto energy = [&](Deciding decide, std::uint64_t key) {
    const SamplePool pool = make_pool(kSide, kSide, kSamples, [=](int x, int y, int s) {
      const float value = unit_double(mix(key, x, y, s)) < 0.02 ? 50.0f : 0.0f;
      return Rgb{value, value, value};
    });
    DirectionalOptions options;
    options.decide = decide;
    options.noise_pool = 0;
    const Selection selection = select_uniform(pool, kSamples);
    const Reconstruction result = run(selection, pool, options);
    double sum = 0.0, taken = 0.0;
    for (const double v : result.image[1].pixels())
      sum += v;
    for (const double v : selection.statistics.mean[1].pixels())
      taken += v;
    return sum / taken;
  };
  double halves = 0.0, own = 0.0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    halves += energy(Deciding::kHalves, run) / kRuns;
    own += energy(Deciding::kOwn, run) / kRuns;
  }
  EXPECT_NEAR(halves, 1.0, 0.03);
  EXPECT_LT(own, 0.9);
}

TEST(DirectionalHalves, FewerThanTwoSamplesAPieceAllDecideAndSaySo) {
  const SamplePool pool = make_pool(20, 20, 4, noisy_picture(20, 20, 7));
  DirectionalOptions options;
  options.decide = Deciding::kHalves;
  const Reconstruction one = run(select_uniform(pool, 1), pool, options);
  EXPECT_EQ(one.image, run(select_uniform(pool, 1), pool).image);
  EXPECT_EQ(one.notes.size(), 1u);
  const Selection uneven = select_counts(pool, [](int x, int) { return x % 4 == 0 ? 1 : 3; });
  const Reconstruction three = run(uneven, pool, options);
  EXPECT_TRUE(three.notes.empty());
  for (const double v : three.image[1].pixels())
    ASSERT_TRUE(std::isfinite(v));
}

TEST(Directional, EstimatedVarianceIsTheSpreadOverIndependentImages) {
  const int size = 44, repeats = 120;
  const std::vector<FilmPosition> film = quarters(8);
  for (const auto& [base, pieces] : {std::pair{BaseImage::kNone, 1},
                                     {BaseImage::kPixelGaussian, 1},
                                     {BaseImage::kChosen, 1},
                                     {BaseImage::kNone, 2},
                                     {BaseImage::kPixelGaussian, 2}}) {
    DirectionalOptions options;
    options.base = base;
    options.size.factor.constant = 0.0;
    options.size.evidence = 0.0;
    options.width.anisotropy = AnisotropySource::kNone;
    Plane sum(size, size), squares(size, size);
    double estimated = 0.0, measured = 0.0;
    for (int r = 0; r < repeats; ++r) {
      const SamplePool pool = make_pool(
          size, size, 8,
          [&](int x, int y, int s) {
            const auto v = static_cast<float>(unit_double(mix(r, x, y, s)));
            return Rgb{v, v, v};
          },
          {.pieces_per_side = pieces}, film);
      const Reconstruction result = run(select_uniform(pool, 8 / (pieces * pieces)), pool, options);
      for (int y = 12; y < size - 12; ++y) {
        for (int x = 12; x < size - 12; ++x) {
          const double value = result.image[0](x, y);
          sum(x, y) += value;
          squares(x, y) += value * value;
          estimated += (*result.variance)[0](x, y) / repeats;
        }
      }
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
      measured += (squares[i] - sum[i] * sum[i] / repeats) / (repeats - 1);
    }
    EXPECT_NEAR(estimated / measured, 1.0, 0.15);  // 3 deviations
  }
}

}  // namespace
}  // namespace spool
