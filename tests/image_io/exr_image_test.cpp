#include "lib/image_io/exr_image.h"
#include "lib/image_io/foreign_picture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/image_io/temporary_folder.h"

namespace spool {
namespace {

class ExrImage : public TemporaryFolder {};

ExrFile three_types(int width, int height) {
  ExrFile image;
  image.width = width;
  image.height = height;
  for (const auto& [name, type] :
       {std::pair{"A.0", PixelType::kFloat}, std::pair{"h", PixelType::kHalf},
        std::pair{"n", PixelType::kUint}}) {
    image.channels.push_back({name, type, Plane(width, height)});
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.channels[0].data(x, y) = static_cast<float>(std::sin(x * 1.7 + y) * 1e6);
      image.channels[1].data(x, y) = 0.25 * x - 0.5 * y;
      image.channels[2].data(x, y) = 4294967295.0 - x - 31.0 * y;
    }
  }
  return image;
}

TEST_F(ExrImage, ReadOfWriteIsIdentityForEveryTypeAndSize) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, std::pair{1, 9}, std::pair{97, 3}, std::pair{64, 64}}) {
    ExrFile image = three_types(width, height);
    image.text_attributes["sampler"] = "uniform";
    image.number_attributes["exposure_scale"] = 1.0 / 3.0;
    const auto compression = width == 97 ? ExrCompression::kRunLengths : ExrCompression::kZip;
    ASSERT_TRUE(write_exr(file("a.exr"), image, {.overwrite = true, .compression = compression}));
    const auto back = read_exr(file("a.exr"));
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_EQ(back->channels.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(back->channels[c].name, image.channels[c].name);
      EXPECT_EQ(back->channels[c].type, image.channels[c].type);
      EXPECT_EQ(back->channels[c].data, image.channels[c].data) << width << " x " << height;
    }
    EXPECT_EQ(back->text_attributes.at("sampler"), "uniform");
    EXPECT_EQ(back->number_attributes.at("exposure_scale"), 1.0 / 3.0);
  }
}

TEST_F(ExrImage, NonFiniteAndDenormalFloatsSurvive) {
  ExrFile image = exr_from_rgb(make_rgb(2, 2));
  image.channels[0].data(0, 0) = std::numeric_limits<double>::quiet_NaN();
  image.channels[0].data(1, 0) = std::numeric_limits<double>::infinity();
  image.channels[0].data(0, 1) = std::numeric_limits<float>::denorm_min();
  image.channels[0].data(1, 1) = -0.0;
  ASSERT_TRUE(write_exr(file("a.exr"), image));
  const auto back = read_exr(file("a.exr"));
  ASSERT_TRUE(back) << back.error().message;
  const Plane& red = *back->find("R");
  EXPECT_TRUE(std::isnan(red(0, 0)));
  EXPECT_TRUE(std::isinf(red(1, 0)));
  EXPECT_EQ(red(0, 1), static_cast<double>(std::numeric_limits<float>::denorm_min()));
  EXPECT_TRUE(std::signbit(red(1, 1)));
}

TEST_F(ExrImage, ValueThatTheTypeCannotHoldIsNamedWithItsPixel) {
  const auto message_for = [&](PixelType type, double value) {
    ExrFile image{.width = 3, .height = 2, .channels = {{"n", type, Plane(3, 2)}}};
    image.channels[0].data(2, 1) = value;
    const auto written = write_exr(file("a.exr"), image);
    EXPECT_FALSE(written);
    return written ? std::string() : written.error().message;
  };
  for (const double bad : {-1.0, 0.5, 4294967296.0, std::nan("")}) {
    EXPECT_NE(message_for(PixelType::kUint, bad).find("pixel 2, 1"), std::string::npos) << bad;
  }
  EXPECT_NE(message_for(PixelType::kHalf, 65520.0).find("pixel 2, 1"), std::string::npos);
  EXPECT_NE(message_for(PixelType::kFloat, 1e300).find("pixel 2, 1"), std::string::npos);
  EXPECT_EQ(files_in_folder(), 0u) << "a refused write leaves nothing behind";
}

TEST_F(ExrImage, ExistingTargetIsKeptUnlessOverwriteIsAsked) {
  write_bytes(file("a.exr"), "precious");
  const ExrFile image = exr_from_rgb(make_rgb(2, 2, 0.5));
  const auto refused = write_exr(file("a.exr"), image);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(bytes_of(file("a.exr")), "precious");
  EXPECT_TRUE(write_exr(file("a.exr"), image, {.overwrite = true}));
  EXPECT_TRUE(read_exr(file("a.exr")));
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(ExrImage, MissingFolderAndMissingFileAreIoErrors) {
  const auto written = write_exr(file("none/a.exr"), exr_from_rgb(make_rgb(1, 1)));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kIo);
  const auto read = read_exr(file("none.exr"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kIo);
}

TEST_F(ExrImage, AGreyPictureIsYAndNoDepthOrCount) {
  const auto one = [&](const char* name) {
    const ExrFile image{
        .width = 1, .height = 1, .channels = {{name, PixelType::kFloat, Plane(1, 1, 7)}}};
    EXPECT_TRUE(write_exr(file("a.exr"), image, {.overwrite = true}));
  };
  for (const char* name : {"Y", "V"}) {
    one(name);
    const auto picture = read_picture(file("a.exr"));
    ASSERT_TRUE(picture) << name;
    EXPECT_EQ(picture->rgb[2](0, 0), 7.0);
    EXPECT_EQ(picture->channel, name);
  }
  for (const char* name : {"n", "depth.Z", "A"}) {
    one(name);
    EXPECT_FALSE(read_picture(file("a.exr"))) << name;
    const auto map = read_single_or_picture(file("a.exr"));
    ASSERT_TRUE(map) << name;
    EXPECT_EQ(map->rgb[0](0, 0), 7.0);
  }
}

}  // namespace
}  // namespace spool
