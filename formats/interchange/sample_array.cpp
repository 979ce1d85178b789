#include "formats/interchange/sample_array.h"

#include <cassert>
#include <cmath>
#include <cstring>

namespace spool::interchange {
namespace {

// Runs of neighbouring elements; gaps between runs that are wanted together are not read.
Result<void> read_pixel_major(const SampleArray& array, const SampleBox& box,
                              std::span<std::byte> out) {
  const uint64_t value = element_bytes(array.type) * array.stride();
  const uint64_t pixel = value * array.samples;
  const bool whole = box.s0 == 0 && box.s1 == array.samples;
  const uint64_t columns = box.x1 - box.x0;
  const uint64_t run = whole ? columns * pixel : (box.s1 - box.s0) * value;
  size_t at = 0;
  for (uint64_t y = box.y0; y < box.y1; ++y) {
    for (uint64_t x = box.x0; x < box.x1; x += whole ? columns : 1) {
      const uint64_t from = array.offset + (y * array.width + x) * pixel + box.s0 * value;
      SPOOL_TRY(array.file->read_at(from, out.subspan(at, run)));
      at += run;
    }
  }
  return {};
}

Result<void> read_sample_major(const SampleArray& array, const SampleBox& box,
                               std::span<std::byte> out) {
  const uint64_t value = element_bytes(array.type) * array.stride();
  const uint64_t columns = box.x1 - box.x0, rows = box.y1 - box.y0, samples = box.s1 - box.s0;
  const bool whole_rows = columns == array.width;
  std::vector<std::byte> plane(columns * rows * value);
  for (uint64_t s = 0; s < samples; ++s) {
    const uint64_t start = array.offset + (box.s0 + s) * array.height * array.width * value;
    for (uint64_t y = 0; y < rows; y += whole_rows ? rows : 1) {
      const uint64_t from = start + ((box.y0 + y) * array.width + box.x0) * value;
      SPOOL_TRY(array.file->read_at(
          from, std::span(plane).subspan(y * columns * value,
                                         whole_rows ? plane.size() : columns * value)));
    }
    for (uint64_t p = 0; p < rows * columns; ++p)
      std::memcpy(&out[(p * samples + s) * value], &plane[p * value], value);
  }
  return {};
}

// Samples of a box [y][x][s][c + skipped] on their way to planes [c][y][x][s].
struct Transposition {
  std::span<const std::byte> box;
  std::span<std::byte> out;
  BoxPart part;
  uint64_t block_pixels = 0;
  uint32_t components = 0, stride = 0;
};

// A pixel's samples lie in the cache while its components are taken apart. `Stride` is that of the
// array where it is known before, so that the innermost loop runs in vectors; 0: any.
template <class T, uint32_t Stride, class Convert>
void scatter_by(const Transposition& from, Convert& convert) {
  using Stored = decltype(convert(T{}));
  const BoxPart& part = from.part;
  const size_t stride = Stride != 0 ? Stride : from.stride;
  const size_t run = part.count * sizeof(Stored), plane = from.block_pixels * run;
  assert(plane * from.components == from.out.size());
  assert((part.to + part.pixels) * run <= plane && part.first + part.count <= part.samples);
  assert(part.pixels * part.samples * stride * sizeof(T) == from.box.size());
  for (uint64_t p = 0; p < part.pixels; ++p) {
    const std::byte* pixel = from.box.data() + (p * part.samples + part.first) * stride * sizeof(T);
    for (uint32_t c = 0; c < from.components; ++c) {
      std::byte* to = from.out.data() + c * plane + (part.to + p) * run;
      for (uint32_t s = 0; s < part.count; ++s) {
        T source;  // at any alignment
        std::memcpy(&source, pixel + (s * stride + c) * sizeof(T), sizeof(T));
        const Stored stored = convert(source);
        std::memcpy(to + s * sizeof(Stored), &stored, sizeof(Stored));
      }
    }
  }
}

template <class T, class Convert>
void scatter(const Transposition& from, Convert&& convert) {
  switch (from.stride) {
    case 1:
      return scatter_by<T, 1>(from, convert);
    case 3:
      return scatter_by<T, 3>(from, convert);
    default:
      return scatter_by<T, 0>(from, convert);
  }
}

}  // namespace

uint64_t element_bytes(ElementType type) {
  switch (type) {
    case ElementType::kFloat16:
      return 2;
    case ElementType::kFloat32:
      return 4;
    case ElementType::kFloat64:
      return 8;
    case ElementType::kUint32:
      return 4;
    case ElementType::kUint8:
      return 1;
  }
  return 0;
}

format::DataType stored_type(ElementType type) {
  switch (type) {
    case ElementType::kFloat16:
      return format::DataType::kFloat16;
    case ElementType::kFloat32:
    case ElementType::kFloat64:
      return format::DataType::kFloat32;
    case ElementType::kUint32:
    case ElementType::kUint8:
      return format::DataType::kUint32;
  }
  return format::DataType::kFloat32;
}

uint64_t SampleArray::bytes() const {
  return element_bytes(type) * width * height * samples * stride();
}

Result<void> read_box(const SampleArray& array, const SampleBox& box, std::vector<std::byte>& out) {
  out.resize(element_bytes(array.type) * array.stride() * (box.y1 - box.y0) * (box.x1 - box.x0) *
             (box.s1 - box.s0));
  return array.sample_major ? read_sample_major(array, box, out)
                            : read_pixel_major(array, box, out);
}

bool to_planar(std::span<const std::byte> box, const SampleArray& array, const BoxPart& part,
               uint64_t block_pixels, std::span<std::byte> out, ValueCounts& counts) {
  bool all_fit = true;
  const Transposition from{box, out, part, block_pixels, array.components, array.stride()};
  uint32_t non_finite = 0, at_half_limit = 0;  // as wide as the values, for loops in vectors
  switch (array.type) {
    case ElementType::kFloat16:
      scatter<uint16_t>(from, [&](uint16_t half) {
        const uint16_t magnitude = half & 0x7FFF;
        non_finite += magnitude >= 0x7C00;
        at_half_limit += magnitude == 0x7BFF;
        return half;
      });
      break;
    case ElementType::kFloat32:
      scatter<uint32_t>(from, [&](uint32_t bits) {  // as bits: a NaN keeps its payload
        non_finite += (bits & 0x7F800000) == 0x7F800000;
        return bits;
      });
      break;
    case ElementType::kFloat64:
      scatter<double>(from, [&](double value) {
        const float narrow = static_cast<float>(value);
        non_finite += !std::isfinite(value);
        if (std::isfinite(value) && !std::isfinite(narrow)) all_fit = false;
        return narrow;
      });
      break;
    case ElementType::kUint32:
      scatter<uint32_t>(from, [](uint32_t value) { return value; });
      break;
    case ElementType::kUint8:
      scatter<uint8_t>(from, [](uint8_t value) { return uint32_t{value}; });
      break;
  }
  counts.non_finite += non_finite;
  counts.at_half_limit += at_half_limit;
  return all_fit;
}

}  // namespace spool::interchange
