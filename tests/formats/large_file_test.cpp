// F12: files beyond 4 GiB, and how little of a file is touched (1024 x 1024 pixels; 4096 x 4096 in
// a whole trust run, as a sparse file of 6.4 GB).
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "formats/dump_check.h"
#include "tests/formats/large_dump.h"
#include "tests/support/trust.h"

namespace spool::format {
namespace {

TEST(LargeFile, IsWrittenCheckedAndReadAtRandom) {
  const ScratchFolder folder;
  const auto path = folder / "large.spool";
  const auto side = static_cast<uint32_t>(test::trust_count(1024, 4096));
  const MadeDump dump = large_dump(side);
  ASSERT_TRUE(write_large_dump(path, dump));
  if (test::whole_trust_run()) {
    EXPECT_GT(std::filesystem::file_size(path), uint64_t{6} << 30);
  }
  const auto reader = SpoolReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_TRUE(reader->complete());
  const DumpGeometry geometry(dump.header);
  const Bytes zeros(geometry.raw_bytes(0, 0, 0));
  for (uint32_t i = 0; i < 1000; ++i) {
    const uint64_t random = mix(i);
    const auto tile = static_cast<uint32_t>(random % reader->tiles());
    // Every third one where there is data.
    auto block = static_cast<uint32_t>((random >> 32) % reader->blocks());
    for (uint32_t b = 0; i % 3 == 0 && b < reader->blocks(); ++b)
      if (is_filled(*reader, tile, b)) block = b;
    const Bytes expected = is_filled(*reader, tile, block)
                               ? block_bytes(geometry, 0, tile, block, dump.seed, false)
                               : zeros;
    const auto read = reader->read_block(0, tile, block);
    ASSERT_TRUE(read && *read == expected) << tile << " " << block;
    const auto mapped = reader->map_block(0, tile, block);
    ASSERT_TRUE(mapped && std::ranges::equal(*mapped, expected));
  }
  const auto report = check_dump(path);
  ASSERT_TRUE(report && report->complete && report->intact());
  struct rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss / 1024, 1024);
}

// The first record of the second half is damaged: many threads read the headers, and the error is
// that of the first damaged one.
TEST(LargeFile, FirstDamagedHeaderIsNamedForAnyNumberOfThreads) {
  const ScratchFolder folder;
  const auto path = folder / "large.spool";
  MadeDump dump;
  dump.header = small_header(1024, 1024, 2, 1, 8);
  dump.smooth = true;
  ASSERT_TRUE(make_dump(path, dump));
  Bytes bytes = read_bytes(path);
  const uint64_t record = kUnit + 3 * 64 * 4;  // header and payload of a block
  const uint64_t first = 7 * kUnit;            // after file header, IMAG and CHAN
  const auto place = [&](uint64_t n) { return first + n * record; };
  for (const uint64_t n : {30000u, 20001u, 8500u}) {
    bytes[place(n) + 50] ^= std::byte{1};
    write_bytes(path, bytes);
    const auto refused = SpoolReader::open(path);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kDamage);
    EXPECT_NE(refused.error().message.find(fmt::format("offset {}", place(n))), std::string::npos)
        << refused.error().message << " " << place(n);
  }
}

// R, G and B of 64 x 64 pixels anywhere in a 1080p dump: less than 2 % of its bytes, opening
// included.
TEST(LargeFile, WindowTouchesLittleOfTheFile) {
  const ScratchFolder folder;
  const auto path = folder / "hd.spool";
  MadeDump dump;
  dump.header = small_header(1920, 1080, 16, 16, 64, DataType::kFloat16);
  add_group(dump.header, {"albedo.R", "albedo.G", "albedo.B", "depth.Z"}, DataType::kFloat16);
  dump.smooth = true;
  ASSERT_TRUE(make_dump(path, dump));
  const double bytes = static_cast<double>(std::filesystem::file_size(path));
  for (const PixelRect rect : {PixelRect{640, 512, 704, 576}, PixelRect{1000, 1000, 1064, 1064}}) {
    const auto reader = SpoolReader::open(path);
    ASSERT_TRUE(reader);
    const auto window = reader->read_region("radiance", rect, 0, 16);
    ASSERT_TRUE(window && window->size() == size_t{3} * 64 * 64 * 16);
    const double touched = static_cast<double>(reader->bytes_read()) / bytes;
    RecordProperty("per_mille", static_cast<int>(touched * 1000));
    EXPECT_LT(touched, 0.02);
  }
}

}  // namespace
}  // namespace spool::format
