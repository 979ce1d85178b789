#include "lib/image_io/picture.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/png_writer.h"
#include "tests/image_io/temporary_folder.h"

namespace spool {
namespace {

double decoded(double v) {
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double luminance_of(Rgb8 c) {
  return luminance(decoded(c[0] / 255.0), decoded(c[1] / 255.0), decoded(c[2] / 255.0));
}

TEST(ToneMap, GreyImageOfAnyExposureComesOutAsMiddleGrey) {
  for (const double level : {0.01, 1.0, 50.0}) {
    const RgbImage image = make_rgb(4, 3, level);
    const double exposure = tone_exposure(image);
    EXPECT_NEAR(exposure, 0.18 / (level + 1e-4), 1e-9 / level);
    // sRGB of 0.18 is 0.4613; the 1e-4 under the logarithm moves 0.01 by 1 %.
    EXPECT_NEAR(tone_map(image, exposure).at(2, 1)[0], 118, 1) << level;
  }
}

// Grey beside a tenth of black. Middle grey is that of log-averages, so black counts, alike in
// every unit.
TEST(ToneMap, RadianceInAnotherUnitIsTheSamePicture) {
  const auto exposed_grey = [](double radiance) {
    RgbImage image = make_rgb(10, 1, radiance);
    for (Plane& plane : image)
      plane[3] = 0.0;
    return radiance * tone_exposure(image);
  };
  EXPECT_NEAR(exposed_grey(1e-6), exposed_grey(1e-30), 1e-9);
  EXPECT_NEAR(exposed_grey(1e6), exposed_grey(1e30), 1e-9);
  EXPECT_NEAR(exposed_grey(1e-6), 0.18 * std::pow(0.009, -0.1), 0.01);
  EXPECT_NEAR(exposed_grey(1e6), 0.18 * std::pow(0.9e-6, -0.1), 0.01);
  EXPECT_NEAR(exposed_grey(1.0), 0.18 * std::pow(1e-4, -0.1), 0.01);
}

TEST(ToneMap, NonFinitePixelsStandOutAndDoNotSetTheExposure) {
  RgbImage image = make_rgb(3, 1, 0.5);
  image[1](1, 0) = std::nan("");
  EXPECT_DOUBLE_EQ(tone_exposure(image), 0.18 / std::exp(std::log(0.5 + 1e-4)));
  EXPECT_EQ(tone_map(image, 1.0).at(1, 0), kNotFinite);
  EXPECT_NE(tone_map(image, 1.0).at(0, 0), kNotFinite);
}

TEST(SequentialColour, BrightnessRisesWithTheValue) {
  for (int i = 1; i <= 64; ++i) {
    EXPECT_GT(luminance_of(sequential_colour(i / 64.0)),
              luminance_of(sequential_colour((i - 1) / 64.0)))
        << i;
  }
  EXPECT_EQ(sequential_colour(-3.0), sequential_colour(0.0));
  EXPECT_EQ(sequential_colour(3.0), sequential_colour(1.0));
}

TEST(DirectionColour, HasPeriod180AndEqualBrightness) {
  for (int angle = 0; angle < 180; angle += 5) {
    EXPECT_EQ(direction_colour(angle), direction_colour(angle + 180.0));
    EXPECT_NE(direction_colour(angle), direction_colour(angle + 90.0));
    EXPECT_NEAR(luminance_of(direction_colour(angle)), luminance_of(direction_colour(0)), 0.12);
  }
}

TEST(CategoryColour, AllDiffer) {
  for (int a = 0; a < kCategoryCount; ++a) {
    for (int b = 0; b < a; ++b)
      EXPECT_NE(category_colour(a), category_colour(b)) << a << " " << b;
  }
}

TEST(ValueRange, LogarithmicPositionsAreEquallySpacedRatios) {
  const Plane a(2, 1, 1.0);
  const Plane b(1, 1, 64.0);
  const Plane* const both[] = {&a, &b};
  const ValueRange range = common_range(both, true);
  EXPECT_TRUE(range.log);
  EXPECT_NEAR(position_in_range(8.0, range), 0.5, 1e-12);
  EXPECT_EQ(position_in_range(0.0, range), 0.0);
  EXPECT_EQ(position_in_range(1e9, range), 1.0);
}

TEST(ValueRange, EmptyAndNonFinitePlanesGiveAUsableRange) {
  const Plane nothing(2, 2, std::nan(""));
  const Plane* const one[] = {&nothing};
  const ValueRange range = common_range(one, true);
  EXPECT_EQ(range.low, 0.0);
  EXPECT_EQ(range.high, 1.0);
  EXPECT_EQ(false_colour(nothing, range).at(1, 1), kNotFinite);
}

TEST(Enlarge, RepeatsPixels) {
  Picture small(2, 1);
  small.set(1, 0, kWhite);
  const Picture large = enlarge(small, 3);
  EXPECT_EQ(large.width, 6);
  EXPECT_EQ(large.height, 3);
  EXPECT_EQ(large.at(2, 2), kBlack);
  EXPECT_EQ(large.at(3, 0), kWhite);
}

TEST(ContactSheet, SmallImagesFillWholePanelsAndAnySizeIsDrawn) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{64, 64}, std::pair{3000, 1}, std::pair{1, 700}}) {
    const Plane plane(width, height, 2.0);
    Panel panel{"density", false_colour(plane, {1, 4, true}), ColourBar{{1, 4, true}, "samples"}};
    const Picture one = labelled_picture(panel);
    EXPECT_GE(one.width, kMinPanelSide);
    EXPECT_GE(one.height, height);
    const Picture sheet = contact_sheet("heading", {panel, panel, panel, panel, panel});
    EXPECT_GT(sheet.width, one.width);
    EXPECT_GT(sheet.height, one.height);
  }
}

class PngFile : public TemporaryFolder {};

TEST_F(PngFile, OpensWithItsSizeAndRefusesToOverwrite) {
  ASSERT_TRUE(write_png(file("a.png"), Picture(7, 5, kWhite), false));
  const std::string bytes = bytes_of(file("a.png"));
  ASSERT_GT(bytes.size(), 24u);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes[19], 7);
  EXPECT_EQ(bytes[23], 5);
  const auto again = write_png(file("a.png"), Picture(1, 1), false);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kUsage);
  EXPECT_EQ(bytes_of(file("a.png")), bytes);
  EXPECT_EQ(files_in_folder(), 1u);
}

}  // namespace
}  // namespace spool
