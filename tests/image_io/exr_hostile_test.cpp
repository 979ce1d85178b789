#include <cstring>

#include <gtest/gtest.h>

#include "lib/image_io/exr_image.h"
#include "tests/image_io/temporary_folder.h"

namespace spool {
namespace {

class HostileExr : public TemporaryFolder {
 protected:
  std::string good_file() {
    ExrFile image = exr_from_rgb(make_rgb(16, 40));
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 16; ++x)
        image.channels[0].data(x, y) = x * 0.37 + y * y;
    }
    EXPECT_TRUE(write_exr(file("good.exr"), image, {.overwrite = true}));
    return bytes_of(file("good.exr"));
  }
};

TEST_F(HostileExr, EveryCutIsAnError) {
  const std::string good = good_file();
  for (std::size_t size = 0; size < good.size(); ++size) {
    write_bytes(file("cut.exr"), good.substr(0, size));
    const auto read = read_exr(file("cut.exr"));
    ASSERT_FALSE(read) << "cut at " << size << " of " << good.size();
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
  }
}

TEST_F(HostileExr, EveryChangedByteIsReadOrRefusedWithoutACrash) {
  const std::string good = good_file();
  constexpr char kValues[] = {'\x00', '\x01', '\x7f', '\x80', '\xff'};
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = kValues[at % 5];
    write_bytes(file("bad.exr"), bad);
    const auto read = read_exr(file("bad.exr"));
    if (!read) {
      EXPECT_NE(read.error().message.find("bad.exr"), std::string::npos);
    }
  }
}

// Finds the attribute's value in the header, so that a test can lie about it.
std::size_t value_of(const std::string& bytes, const std::string& name, const std::string& type) {
  const std::string key = name + '\0' + type + '\0';
  return bytes.find(key) + key.size() + 4;
}

TEST_F(HostileExr, ClaimedSizeIsRefusedBeforeMemoryIsTaken) {
  const std::string good = good_file();
  for (const std::int32_t claimed : {20000, 1000000, 2147483646}) {
    for (const std::size_t corner : {8u, 12u}) {
      std::string bad = good;
      std::memcpy(&bad[value_of(bad, "dataWindow", "box2i") + corner], &claimed, 4);
      write_bytes(file("bomb.exr"), bad);
      EXPECT_FALSE(read_exr(file("bomb.exr"))) << claimed << " at " << corner;
    }
  }
}

TEST_F(HostileExr, SizeLimitHolds) {
  good_file();
  EXPECT_TRUE(read_exr(file("good.exr"), {.max_pixels = 640}));
  const auto read = read_exr(file("good.exr"), {.max_pixels = 639});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kData);
  EXPECT_FALSE(read_exr(file("good.exr"), {.max_bytes = 640 * 3 * 8 - 1}));
}

TEST_F(HostileExr, OtherFilesAreNamedAsSuch) {
  write_bytes(file("text.exr"), "not an image at all");
  const auto read = read_exr(file("text.exr"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kData);
}

}  // namespace
}  // namespace spool
