// The codec takes exactly the frames the page allows, and nothing decodes to another size.
#include <cstring>

#include <gtest/gtest.h>
#include <zstd.h>

#include "formats/chunk_codec.h"
#include "formats/crc32.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

Bytes ramp(size_t bytes) {
  Bytes data(bytes);
  for (size_t i = 0; i < bytes; ++i)
    data[i] = static_cast<std::byte>(i / 16);
  return data;
}

struct FrameOptions {
  bool checksum = true;
  bool content_size = true;
  int window_log = 0;
};

Bytes frame_of(const Bytes& plain, FrameOptions options = {}) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, options.checksum ? 1 : 0);
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, options.content_size ? 1 : 0);
  if (options.window_log != 0) {
    ZSTD_CCtx_setParameter(context, ZSTD_c_windowLog, options.window_log);
  }
  Bytes frame(ZSTD_compressBound(plain.size()) + 64);
  ZSTD_outBuffer out{frame.data(), frame.size(), 0};
  if (options.window_log == 0) {
    out.pos = ZSTD_compress2(context, frame.data(), frame.size(), plain.data(), plain.size());
  } else {
    // Streaming without a pledged size: the frame then carries a window descriptor.
    ZSTD_inBuffer in{plain.data(), plain.size(), 0};
    ZSTD_compressStream2(context, &out, &in, ZSTD_e_continue);
    while (ZSTD_compressStream2(context, &out, &in, ZSTD_e_end) != 0) {
    }
  }
  frame.resize(out.pos);
  ZSTD_freeCCtx(context);
  return frame;
}

bool decodes(const Bytes& stored, const Bytes& expected) {
  Bytes plain(expected.size());
  return decode_payload(Codec::kZstd, Filter::kNone, stored, 4, plain).has_value() &&
         plain == expected;
}

TEST(ChunkCodec, ShuffleFollowsThePage) {
  const Bytes plain = ramp(64);
  Bytes mixed(plain.size());
  for (const uint32_t element : {2u, 4u}) {
    const size_t n = plain.size() / element;
    shuffle_bytes(plain, element, mixed);
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = 0; k < element; ++k)
        EXPECT_EQ(mixed[k * n + i], plain[i * element + k]);
    }
    Bytes back(plain.size());
    unshuffle_bytes(mixed, element, back);
    EXPECT_EQ(back, plain);
  }
}

TEST(ChunkCodec, TakesOnlyTheFramesOfThePage) {
  const Bytes plain = ramp(5000);
  const Bytes frame = frame_of(plain);
  EXPECT_TRUE(decodes(frame, plain));
  EXPECT_FALSE(decodes(frame_of(plain, {.checksum = false}), plain));
  EXPECT_FALSE(decodes(frame_of(plain, {.content_size = false}), plain));
  EXPECT_FALSE(decodes(frame, ramp(4999)));
  EXPECT_FALSE(decodes(frame, ramp(5001)));
  Bytes longer = frame;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decodes(longer, plain));
  Bytes shorter = frame;
  shorter.pop_back();
  EXPECT_FALSE(decodes(shorter, plain));
  Bytes two = frame_of(ramp(2500));
  const Bytes half = two;
  two.insert(two.end(), half.begin(), half.end());
  EXPECT_FALSE(decodes(two, plain));
  // A skippable frame of no bytes in front.
  Bytes skippable(8 + frame.size());
  const std::array<uint8_t, 4> skippable_magic = {0x50, 0x2A, 0x4D, 0x18};
  std::memcpy(skippable.data(), skippable_magic.data(), 4);
  std::memcpy(skippable.data() + 8, frame.data(), frame.size());
  EXPECT_FALSE(decodes(skippable, plain));
  EXPECT_FALSE(decodes({}, plain));
  EXPECT_FALSE(decodes(Bytes(100, std::byte{0xFF}), plain));
}

TEST(ChunkCodec, RefusesAWindowAboveTheLimit) {
  const Bytes plain = ramp(5000);
  const auto with_window = [&](uint8_t descriptor) {
    // The single-segment header (descriptor, content size in 2 bytes) becomes one with a window.
    const Bytes frame = frame_of(plain);
    Bytes rebuilt(frame.size() + 1);
    std::memcpy(rebuilt.data(), frame.data(), 4);
    rebuilt[4] = std::byte{0x44};
    rebuilt[5] = std::byte{descriptor};
    std::memcpy(rebuilt.data() + 6, frame.data() + 5, frame.size() - 5);
    return rebuilt;
  };
  EXPECT_TRUE(decodes(with_window(16 << 3), plain));         // 2^26 = 64 MiB
  EXPECT_FALSE(decodes(with_window((16 << 3) | 1), plain));  // 72 MiB
  EXPECT_FALSE(decodes(with_window(20 << 3), plain));
}

TEST(ChunkCodec, KeepsRawWhatDoesNotShrink) {
  Bytes noise(4096);
  for (size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<std::byte>(mix(i) & 0xFF);
  EXPECT_FALSE(compress_payload(noise, 4));
  const Bytes plain = ramp(4096);
  const auto packed = compress_payload(plain, 4);
  ASSERT_TRUE(packed);
  EXPECT_LE(packed->size(), plain.size() - plain.size() / 20);
  Bytes back(plain.size());
  ASSERT_TRUE(decode_payload(Codec::kZstd, Filter::kByteShuffle, *packed, 4, back));
  EXPECT_EQ(back, plain);
}

TEST(Crc32, HasTheKnownCheckValue) {
  const std::string_view digits = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(digits))), 0xCBF43926u);
}

// The slow twin, bit by bit: the reflected polynomial of zlib, PNG and zip.
uint32_t crc32_of_bits(std::span<const std::byte> bytes) {
  uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

TEST(Crc32, EqualsItsTwinAtEveryLengthAndPlace) {
  Bytes data(1500);
  for (size_t i = 0; i < data.size(); ++i)
    data[i] = static_cast<std::byte>(i * i * 31 + i / 7);
  for (size_t begin = 0; begin < 70; begin += 3) {
    for (size_t bytes = 0; bytes < 300; bytes += bytes < 80 ? 1 : 37) {
      const auto part = std::span(data).subspan(begin, bytes);
      EXPECT_EQ(crc32(part), crc32_of_bits(part)) << begin << "+" << bytes;
    }
  }
  EXPECT_EQ(crc32(data), crc32_of_bits(data));
}

}  // namespace
}  // namespace spool::format
