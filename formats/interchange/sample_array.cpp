#include "formats/interchange/sample_array.h"

#include <cmath>
#include <cstring>

#include "formats/byte_io.h"

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

template <class T>
void scatter(std::span<const std::byte> box, const SampleArray& array, uint64_t pixels,
             uint32_t box_samples, uint32_t first, uint32_t count, std::span<std::byte> out,
             auto&& convert) {
  const uint64_t stride = array.stride();
  size_t to = 0;
  for (uint32_t c = 0; c < array.components; ++c) {
    for (uint64_t p = 0; p < pixels; ++p) {
      for (uint32_t s = 0; s < count; ++s) {
        const T source =
            format::load<T>(box, ((p * box_samples + first + s) * stride + c) * sizeof(T));
        const auto stored = convert(source);
        format::store(out, to, stored);
        to += sizeof(stored);
      }
    }
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

Result<std::vector<std::byte>> read_box(const SampleArray& array, const SampleBox& box) {
  std::vector<std::byte> out(element_bytes(array.type) * array.stride() * (box.y1 - box.y0) *
                             (box.x1 - box.x0) * (box.s1 - box.s0));
  SPOOL_TRY(array.sample_major ? read_sample_major(array, box, out)
                               : read_pixel_major(array, box, out));
  return out;
}

bool to_planar(std::span<const std::byte> box, const SampleArray& array, uint64_t pixels,
               uint32_t box_samples, uint32_t first, uint32_t count, std::span<std::byte> out,
               ValueCounts& counts) {
  bool all_fit = true;
  const auto run = [&]<class T>(T, auto&& convert) {
    scatter<T>(box, array, pixels, box_samples, first, count, out, convert);
  };
  switch (array.type) {
    case ElementType::kFloat16:
      run(uint16_t{}, [&](uint16_t half) {
        const uint16_t magnitude = half & 0x7FFF;
        counts.non_finite += magnitude >= 0x7C00;
        counts.at_half_limit += magnitude == 0x7BFF || magnitude == 0x7C00;
        return half;
      });
      break;
    case ElementType::kFloat32:
      run(uint32_t{}, [&](uint32_t bits) {  // as bits: a NaN keeps its payload
        counts.non_finite += (bits & 0x7F800000) == 0x7F800000;
        return bits;
      });
      break;
    case ElementType::kFloat64:
      run(double{}, [&](double value) {
        const float narrow = static_cast<float>(value);
        counts.non_finite += !std::isfinite(value);
        if (std::isfinite(value) && !std::isfinite(narrow)) all_fit = false;
        return narrow;
      });
      break;
    case ElementType::kUint32:
      run(uint32_t{}, [](uint32_t value) { return value; });
      break;
    case ElementType::kUint8:
      run(uint8_t{}, [](uint8_t value) { return uint32_t{value}; });
      break;
  }
  return all_fit;
}

}  // namespace spool::interchange
