// One array of numbers inside a foreign file: where it lies and how its axes run.
//
// Boxes of it are read with positional reads, so that a file of any size is turned into blocks in
// bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/file_handle.h"
#include "formats/record_layout.h"
#include "lib/core/error.h"

namespace spool::interchange {

enum class ElementType { kFloat16, kFloat32, kFloat64, kUint32, kUint8 };

uint64_t element_bytes(ElementType type);
// What the numbers become in a .spool: f64 is narrowed to f32, u8 is widened to u32.
format::DataType stored_type(ElementType type);

struct SampleArray {
  const format::FileHandle* file = nullptr;
  uint64_t offset = 0;  // of the first element
  ElementType type = ElementType::kFloat32;
  bool sample_major = false;  // [s][y][x][c] instead of [y][x][s][c]
  uint32_t height = 1;
  uint32_t width = 1;
  uint32_t samples = 1;
  uint32_t components = 1;
  uint32_t skipped = 0;  // values that follow the components of each sample and are not wanted

  uint32_t stride() const { return components + skipped; }
  uint64_t bytes() const;  // of all elements
};

// Half-open ranges.
struct SampleBox {
  uint32_t y0 = 0, y1 = 0;
  uint32_t x0 = 0, x1 = 0;
  uint32_t s0 = 0, s1 = 0;
};

// Elements [y][x][s][c] of a box inside the array, in the array's own type, skipped ones included;
// `out` becomes as large as they are.
Result<void> read_box(const SampleArray& array, const SampleBox& box, std::vector<std::byte>& out);

// What was noticed while values were taken over.
struct ValueCounts {
  uint64_t non_finite = 0;
  uint64_t at_half_limit = 0;  // |v| = 65504 in an f16 source
};

// Pixels and samples of a box that go into a block, and where: the box holds `pixels` pixels of
// `samples` samples each; samples [first, first + count) of them become those of the block's pixels
// from `to` on.
struct BoxPart {
  uint64_t pixels = 0, to = 0;
  uint32_t samples = 0, first = 0, count = 0;
};

// That part as the planar block stored[c][y][x][s] of stored_type(array.type). `out` is the whole
// block of `block_pixels` pixels and has exactly that size. False when a finite f64 does not fit
// f32. A box should stay in the processor's cache: each block goes through it.
bool to_planar(std::span<const std::byte> box, const SampleArray& array, const BoxPart& part,
               uint64_t block_pixels, std::span<std::byte> out, ValueCounts& counts);

}  // namespace spool::interchange
