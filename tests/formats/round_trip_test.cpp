// What is written is what is read: bytes, floats, regions, mappings; and the page's own example.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "formats/dump_check.h"
#include "formats/half_float.h"
#include "formats/spool_reader.h"
#include "formats/spool_writer.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

template <class T>
std::string why(const Result<T>& result) {
  return result ? "" : result.error().message;
}

Bytes example_bytes() {
  const std::vector<float> values = {1.0f, 2.0f, 0.5f, 0.25f, 0.0f, -0.0f};
  const auto raw = std::as_bytes(std::span(values));
  return {raw.begin(), raw.end()};
}

TEST(SpoolFormat, WorkedExampleOfThePageIsWrittenByteForByte) {
  const ScratchFolder folder;
  const auto path = folder / "example.spool";
  auto writer = SpoolWriter::create(path, small_header(2, 1, 1, 1), {.uuid = kFixedUuid});
  ASSERT_TRUE(writer) << why(writer);
  ASSERT_TRUE(writer->write_block(0, 0, 0, 1, example_bytes()));
  ASSERT_TRUE(writer->finish());
  const Bytes bytes = read_bytes(path);
  ASSERT_EQ(bytes.size(), 896u);
  // CRCs as printed in formats/spool.md 11.
  const auto at = [&](size_t offset) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i)
      value = value << 8 | std::to_integer<uint32_t>(bytes[offset + i]);
    return value;
  };
  EXPECT_EQ(at(0x03C), 0x78ED3841u);
  EXPECT_EQ(at(0x07C), 0xB34DEF63u);
  EXPECT_EQ(at(0x0FC), 0xBEB675DAu);
  EXPECT_EQ(at(0x1FC), 0x6199D312u);
  EXPECT_EQ(at(0x27C), 0x52144B9Bu);
  EXPECT_EQ(at(0x37C), 0xB6866FD0u);
}

// Reads every block of a dump in every way and compares with what was written.
void expect_contents(const std::filesystem::path& path, const MadeDump& dump) {
  auto reader = SpoolReader::open(path);
  RC_ASSERT(reader.has_value());
  DumpHeader expected = dump.header;
  expected.uuid = *dump.options.uuid;
  RC_ASSERT(reader->header() == expected);
  RC_ASSERT(reader->meta() == dump.meta);
  const DumpGeometry geometry(dump.header);
  bool complete = true;
  for (uint16_t group = 0; group < geometry.groups().size(); ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        const bool skipped = is_skipped(dump, *geometry.slot(group, tile, block));
        RC_ASSERT(reader->has_block(group, tile, block) == !skipped);
        const auto read = reader->read_block(group, tile, block);
        RC_ASSERT(read.has_value() == !skipped);
        if (skipped) {
          complete = false;
          RC_ASSERT(read.error().code == ErrorCode::kData);
          continue;
        }
        const Bytes written = block_bytes(geometry, group, tile, block, dump.seed, dump.smooth);
        RC_ASSERT(*read == written);
        const auto mapped = reader->map_block(group, tile, block);
        RC_ASSERT(mapped.has_value() == reader->is_raw(group, tile, block));
        if (mapped) {
          RC_ASSERT(Bytes(mapped->begin(), mapped->end()) == written);
          RC_ASSERT(reinterpret_cast<uintptr_t>(mapped->data()) % 64 == 0);
        }
      }
    }
  }
  RC_ASSERT(reader->complete() == complete);
  const auto report = check_dump(path);
  RC_ASSERT(report.has_value());
  RC_ASSERT(report->intact());
  RC_ASSERT(report->complete == complete);
}

MadeDump arbitrary_dump() {
  MadeDump dump;
  dump.header = small_header(*rc::gen::inRange(1u, 40u), *rc::gen::inRange(1u, 40u),
                             *rc::gen::inRange(1u, 12u), *rc::gen::inRange(1u, 9u),
                             *rc::gen::element(8u, 16u, 64u, 256u),
                             *rc::gen::element(DataType::kFloat16, DataType::kFloat32));
  dump.header.sample_order = *rc::gen::element(SampleOrder::kRenderer, SampleOrder::kExchangeable);
  const auto groups = *rc::gen::inRange(0, 6);
  for (int g = 0; g < groups; ++g) {
    const std::string layer = "layer_" + std::to_string(g);
    std::vector<std::string> names;
    const auto channels = *rc::gen::inRange(1, 5);
    for (int c = 0; c < channels; ++c)
      names.push_back(layer + ".C" + std::to_string(c));
    add_group(dump.header, names,
              *rc::gen::element(DataType::kFloat16, DataType::kFloat32, DataType::kUint32),
              *rc::gen::element(Scope::kSample, Scope::kPixel, Scope::kPass),
              static_cast<Semantic>(*rc::gen::inRange(0, 10)));
  }
  const auto texts = *rc::gen::inRange(0, 3);
  for (int m = 0; m < texts; ++m)
    dump.meta.push_back("{\"key\": [" + std::to_string(m) + "]}");
  dump.options.compress = *rc::gen::arbitrary<bool>();
  dump.options.force = true;
  dump.smooth = *rc::gen::arbitrary<bool>();
  dump.seed = *rc::gen::arbitrary<uint64_t>();
  dump.skip_every = *rc::gen::inRange(0u, 5u);
  for (uint8_t& byte : *dump.options.uuid)
    byte = *rc::gen::arbitrary<uint8_t>();
  return dump;
}

RC_GTEST_PROP(SpoolFormat, EveryDumpReadsBackBitForBit, ()) {
  static const ScratchFolder folder;
  const auto path = folder / "any.spool";
  const MadeDump dump = arbitrary_dump();
  const auto made = make_dump(path, dump);
  RC_ASSERT(made.has_value());
  expect_contents(path, dump);
}

// Value of sample s at (x, y) in channel c, straight from the definition of the layout.
float expected_value(const MadeDump& dump, uint16_t group, uint32_t c, uint32_t x, uint32_t y,
                     uint32_t s) {
  const DumpGeometry geometry(dump.header);
  const uint32_t size = dump.header.tile_size;
  const uint32_t tile = y / size * geometry.tiles_x() + x / size;
  const uint32_t block = s / dump.header.block_spp;
  const PixelRect area = geometry.tile_rect(tile);
  const Bytes bytes = block_bytes(geometry, group, tile, block, dump.seed, dump.smooth);
  const size_t count = geometry.block_count(group, block);
  const size_t index =
      ((size_t{c} * area.height() + (y - area.y0)) * area.width() + (x - area.x0)) * count +
      s % dump.header.block_spp;
  if (geometry.groups()[group].type == DataType::kFloat16) {
    uint16_t half = 0;
    std::memcpy(&half, bytes.data() + index * 2, 2);
    return half_to_float(half);
  }
  float value = 0;
  std::memcpy(&value, bytes.data() + index * 4, 4);
  return value;
}

RC_GTEST_PROP(SpoolFormat, RegionHoldsTheSamplesOfItsPixels, ()) {
  static const ScratchFolder folder;
  const auto path = folder / "region.spool";
  MadeDump dump;
  dump.header = small_header(*rc::gen::inRange(1u, 30u), *rc::gen::inRange(1u, 30u),
                             *rc::gen::inRange(1u, 10u), *rc::gen::inRange(1u, 6u));
  add_group(dump.header, {"normal.X", "normal.Y", "normal.Z", "depth.Z"}, DataType::kFloat16);
  dump.options.force = true;
  dump.options.compress = *rc::gen::arbitrary<bool>();
  dump.smooth = dump.options.compress;
  RC_ASSERT(make_dump(path, dump).has_value());
  const auto reader = SpoolReader::open(path);
  RC_ASSERT(reader.has_value());
  const uint32_t x0 = *rc::gen::inRange(0u, dump.header.width);
  const uint32_t y0 = *rc::gen::inRange(0u, dump.header.height);
  const PixelRect rect = {x0, y0, *rc::gen::inRange(x0 + 1, dump.header.width + 1),
                          *rc::gen::inRange(y0 + 1, dump.header.height + 1)};
  const uint32_t begin = *rc::gen::inRange(0u, dump.header.spp);
  const uint32_t count = *rc::gen::inRange(1u, dump.header.spp - begin + 1);
  const bool depth = *rc::gen::arbitrary<bool>();
  const auto values = reader->read_region(depth ? "depth" : "radiance", rect, begin, count);
  RC_ASSERT(values.has_value());
  const uint32_t channels = depth ? 1 : 3;
  RC_ASSERT(values->size() == size_t{channels} * rect.height() * rect.width() * count);
  size_t i = 0;
  for (uint32_t c = 0; c < channels; ++c) {
    for (uint32_t y = rect.y0; y < rect.y1; ++y) {
      for (uint32_t x = rect.x0; x < rect.x1; ++x) {
        for (uint32_t s = begin; s < begin + count; ++s, ++i) {
          const float expected = expected_value(dump, depth ? 1 : 0, depth ? 3 : c, x, y, s);
          RC_ASSERT(std::bit_cast<uint32_t>((*values)[i]) == std::bit_cast<uint32_t>(expected));
        }
      }
    }
  }
}

TEST(SpoolFormat, FirstSamplesTouchOnlyTheirBlocks) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(32, 16, 64, 8, 16);
  add_group(dump.header, {"depth.Z"}, DataType::kFloat32);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_TRUE(reader) << why(reader);
  const uint64_t before = reader->bytes_read();
  ASSERT_TRUE(reader->read_region("radiance", {0, 0, 16, 16}, 0, 9));
  // Two blocks of 3 channels, 16 x 16 pixels, 8 samples, 4 bytes.
  EXPECT_EQ(reader->bytes_read() - before, 2u * 3 * 16 * 16 * 8 * 4);
}

TEST(SpoolFormat, MappedBlockIsVerifiedOnce) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(8, 8, 2, 2);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_TRUE(reader) << why(reader);
  const uint64_t before = reader->bytes_read();
  ASSERT_TRUE(reader->map_block(0, 0, 0));
  ASSERT_TRUE(reader->map_block(0, 0, 0));
  EXPECT_EQ(reader->bytes_read() - before, 3u * 64 * 2 * 4);
}

TEST(SpoolFormat, ManyThreadsShareOneReader) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(40, 40, 8, 2);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_TRUE(reader) << why(reader);
  const DumpGeometry geometry(dump.header);
  std::atomic<size_t> wrong = 0;
  const auto work = [&] {
    for (uint32_t tile = 0; tile < reader->tiles(); ++tile) {
      for (uint32_t block = 0; block < reader->blocks(); ++block) {
        const Bytes expected = block_bytes(geometry, 0, tile, block, dump.seed, dump.smooth);
        const auto mapped = reader->map_block(0, tile, block);
        const auto read = reader->read_block(0, tile, block);
        if (!mapped || !read || *read != expected || !std::ranges::equal(*mapped, expected))
          ++wrong;
      }
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back(work);
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, 0u);
}

TEST(SpoolFormat, PixelAndPassLayersReadWhole) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(false);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_TRUE(reader) << why(reader);
  const DumpGeometry geometry(dump.header);

  const auto film = reader->read_pass_layer("film");
  ASSERT_TRUE(film) << why(film);
  ASSERT_EQ(film->size(), 2u * 3);
  for (uint32_t c = 0; c < 2; ++c) {
    for (uint32_t s = 0; s < 3; ++s) {
      const Bytes bytes = block_bytes(geometry, 2, 0, s / 2, dump.seed, dump.smooth);
      uint32_t expected = 0;
      std::memcpy(&expected, bytes.data() + (c * geometry.block_count(2, s / 2) + s % 2) * 4, 4);
      EXPECT_EQ(std::bit_cast<uint32_t>((*film)[c * 3 + s]), expected);
    }
  }

  const auto reference = reader->read_pixel_layer("reference");
  ASSERT_TRUE(reference) << why(reference);
  ASSERT_EQ(reference->size(), 3u * 5 * 9);
  for (uint32_t c = 0; c < 3; ++c) {
    for (uint32_t y = 0; y < 5; ++y) {
      for (uint32_t x = 0; x < 9; ++x) {
        const uint32_t tile = x / 8;
        const uint32_t columns = tile == 0 ? 8 : 1;
        const Bytes bytes = block_bytes(geometry, 3, tile, 0, dump.seed, dump.smooth);
        uint32_t expected = 0;
        std::memcpy(&expected, bytes.data() + ((c * 5 + y) * columns + x % 8) * 4, 4);
        EXPECT_EQ(std::bit_cast<uint32_t>((*reference)[(c * 5 + y) * 9 + x]), expected);
      }
    }
  }
  EXPECT_EQ(reader->read_region("film", {0, 0, 1, 1}, 0, 1).error().code, ErrorCode::kUsage);
  EXPECT_EQ(reader->read_region("path", {0, 0, 1, 1}, 0, 1).error().code, ErrorCode::kUsage);
  EXPECT_EQ(reader->read_region("lens", {0, 0, 1, 1}, 0, 1).error().code, ErrorCode::kData);
  EXPECT_EQ(reader->read_region("radiance", {0, 0, 10, 1}, 0, 1).error().code, ErrorCode::kUsage);
  EXPECT_EQ(reader->read_region("radiance", {0, 0, 1, 1}, 1, 3).error().code, ErrorCode::kUsage);
  EXPECT_EQ(reader->read_block(0, 99, 0).error().code, ErrorCode::kUsage);
  const auto depth = reader->find_layer("depth");
  ASSERT_TRUE(depth);
  EXPECT_EQ(depth->group, 1);
  EXPECT_EQ(depth->first_channel, 3u);
  EXPECT_EQ(depth->channel_count, 1u);
  EXPECT_EQ(depth->components, std::vector<std::string>{"Z"});
}

TEST(HalfFloat, EveryPatternWidensToItsValue) {
  for (uint32_t bits = 0; bits < 0x10000; ++bits) {
    const float wide = half_to_float(static_cast<uint16_t>(bits));
    const double sign = (bits & 0x8000) != 0 ? -1.0 : 1.0;
    const int exponent = static_cast<int>(bits >> 10 & 31);
    const int fraction = static_cast<int>(bits & 1023);
    if (exponent == 31) {
      EXPECT_EQ(std::isnan(wide), fraction != 0);
      EXPECT_EQ(std::bit_cast<uint32_t>(wide) >> 13 & 1023, static_cast<uint32_t>(fraction));
    } else {
      const double value =
          exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
      EXPECT_EQ(static_cast<double>(wide), sign * value);
    }
    EXPECT_EQ(std::signbit(wide), sign < 0);
  }
}

}  // namespace
}  // namespace spool::format
