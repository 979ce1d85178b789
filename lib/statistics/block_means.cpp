#include "lib/statistics/block_means.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "lib/core/vector_clones.h"
#include "lib/statistics/four_pixels.h"

namespace spool {
namespace {

// Groups of four pixels that take turns, so that divisions need not wait for each other.
constexpr int kGroups = 4, kPixels = kLanes * kGroups;

// The first `count` samples, a multiple of four, of sixteen pixels that all have as many. Lanes are
// independent of each other: wider vectors change no bit.
SPOOL_VECTOR_CLONES void add_sixteen(const float* values, std::ptrdiff_t pixel, int count,
                                     int before, double* to) {
  FourDoubles mean[kGroups];
  std::memcpy(mean, to, sizeof(mean));
  for (int s = 0; s < count; s += kLanes) {
    FourFloats samples[kGroups][kLanes];
    for (int g = 0; g < kGroups; ++g)
      transpose_four(values + g * kLanes * pixel + s, pixel, samples[g]);
    for (int k = 0; k < kLanes; ++k) {
      const double n = before + s + k + 1;
      for (int g = 0; g < kGroups; ++g)
        mean[g] += (__builtin_convertvector(samples[g][k], FourDoubles) - mean[g]) / n;
    }
  }
  std::memcpy(to, mean, sizeof(mean));
}

}  // namespace

void add_means(const float* values, int samples, const std::int32_t* own, int pixels, int before,
               double* mean) {
  for (int x = 0; x < pixels; x += kPixels) {
    const int side_by_side = std::min(kPixels, pixels - x);
    int shared = 0;  // samples that all sixteen have
    if (side_by_side == kPixels) {
      shared = *std::min_element(own + x, own + x + kPixels) / kLanes * kLanes;
      add_sixteen(values + static_cast<std::ptrdiff_t>(x) * samples, samples, shared, before,
                  mean + x);
    }
    for (int p = x; p < x + side_by_side; ++p) {
      const float* value = values + static_cast<std::ptrdiff_t>(p) * samples;
      for (int s = shared; s < own[p]; ++s)
        mean[p] += (static_cast<double>(value[s]) - mean[p]) / (before + s + 1);
    }
  }
}

void add_block_means(const BlockView& block, const CountImage& counts, int row_begin, int row_end,
                     RgbImage& mean) {
  const Rectangle& tile = block.pixels;
  std::vector<std::int32_t> own(static_cast<std::size_t>(tile.width()));
  for (int y = row_begin; y < row_end; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x)
      own[static_cast<std::size_t>(x - tile.x0)] =
          std::clamp(counts(x, y) - block.first, 0, block.samples);
    for (std::size_t c = 0; c < 3; ++c)
      add_means(block.at(tile.x0, y) + c * block.channel(), block.samples, own.data(), tile.width(),
                block.first, &mean[c](tile.x0, y));
  }
}

}  // namespace spool
