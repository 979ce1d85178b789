#include "formats/chunk_codec.h"

#include <cstring>
#include <memory>

#include <zstd.h>

#include "formats/byte_io.h"

namespace spool::format {

namespace {

using enum FailureClass;

// Level 3 makes feature layers 2 to 5 % smaller and radiance no smaller, at half the rate.
constexpr int kLevel = 1;

struct ContextDeleter {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

// Window size of a frame header, RFC 8878 3.1.1.1.2; nullopt for a frame of a single segment, whose
// window is its content size.
std::optional<uint64_t> window_bytes(std::span<const std::byte> frame) {
  const auto descriptor = std::to_integer<uint8_t>(frame[4]);
  if ((descriptor & 0x20) != 0) return std::nullopt;
  const auto window = std::to_integer<uint8_t>(frame[5]);
  const uint64_t base = uint64_t{1} << (10 + (window >> 3));
  return base + base / 8 * (window & 7);
}

// The rules of codec 1 that zstd itself does not enforce.
Judged<void> check_frame(std::span<const std::byte> frame, uint64_t raw_bytes) {
  if (frame.size() < 9 || load<uint32_t>(frame, 0) != ZSTD_MAGICNUMBER) {
    return violates(kDamaged, "payload is not a zstd frame");
  }
  const auto descriptor = std::to_integer<uint8_t>(frame[4]);
  if ((descriptor & 0x04) == 0) return violates(kDamaged, "zstd frame has no checksum");
  if ((descriptor & 0x03) != 0) return violates(kDamaged, "zstd frame names a dictionary");
  if (const auto window = window_bytes(frame); window && *window > kMaxZstdWindow) {
    return violates(kDamaged, "zstd window of {} bytes", *window);
  }
  if (ZSTD_getFrameContentSize(frame.data(), frame.size()) != raw_bytes) {
    return violates(kDamaged, "zstd content size is absent or not {}", raw_bytes);
  }
  if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size()) {
    return violates(kDamaged, "zstd frame does not end with the payload");
  }
  return {};
}

}  // namespace

void shuffle_bytes(std::span<const std::byte> plain, uint32_t element_bytes,
                   std::span<std::byte> shuffled) {
  const size_t count = plain.size() / element_bytes;
  for (size_t k = 0; k < element_bytes; ++k) {
    std::byte* out = shuffled.data() + k * count;
    for (size_t i = 0; i < count; ++i)
      out[i] = plain[i * element_bytes + k];
  }
}

void unshuffle_bytes(std::span<const std::byte> shuffled, uint32_t element_bytes,
                     std::span<std::byte> plain) {
  const size_t count = plain.size() / element_bytes;
  for (size_t k = 0; k < element_bytes; ++k) {
    const std::byte* in = shuffled.data() + k * count;
    for (size_t i = 0; i < count; ++i)
      plain[i * element_bytes + k] = in[i];
  }
}

Judged<void> decode_payload(Codec codec, Filter filter, std::span<const std::byte> stored,
                            uint32_t element_bytes, std::span<std::byte> plain) {
  if (codec == Codec::kNone) {
    if (stored.size() != plain.size()) return violates(kDamaged, "payload has the wrong size");
    std::memcpy(plain.data(), stored.data(), plain.size());
    return {};
  }
  SPOOL_JUDGE(check_frame(stored, plain.size()));
  std::vector<std::byte> shuffled;
  std::span<std::byte> target = plain;
  if (filter == Filter::kByteShuffle) {
    shuffled.resize(plain.size());
    target = shuffled;
  }
  const size_t written =
      ZSTD_decompress(target.data(), target.size(), stored.data(), stored.size());
  if (ZSTD_isError(written) != 0 || written != plain.size()) {
    return violates(kDamaged, "zstd frame does not decode: {}",
                    ZSTD_isError(written) != 0 ? ZSTD_getErrorName(written) : "wrong size");
  }
  if (filter == Filter::kByteShuffle) unshuffle_bytes(shuffled, element_bytes, plain);
  return {};
}

std::optional<std::vector<std::byte>> compress_payload(std::span<const std::byte> plain,
                                                       uint32_t element_bytes) {
  std::vector<std::byte> shuffled(plain.size());
  shuffle_bytes(plain, element_bytes, shuffled);
  const std::unique_ptr<ZSTD_CCtx, ContextDeleter> context(ZSTD_createCCtx());
  if (!context) return std::nullopt;
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  // A frame that does not fit into 95 % is not wanted, so no more room is given.
  std::vector<std::byte> frame(plain.size() - plain.size() / 20);
  const size_t written =
      ZSTD_compress2(context.get(), frame.data(), frame.size(), shuffled.data(), shuffled.size());
  if (ZSTD_isError(written) != 0 || written >= plain.size()) return std::nullopt;
  frame.resize(written);
  return frame;
}

}  // namespace spool::format
