#include "lib/statistics/block_statistics.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "lib/core/vector_clones.h"
#include "lib/statistics/four_pixels.h"

namespace spool {
namespace {

using Floats = FourFloats;
using Doubles = FourDoubles;
using Integers = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

// Mean and M2 of red, green, blue and the signal of four pixels, and the extremes of the signal.
struct Lanes {
  Doubles mean[4], m2[4], minimum, maximum;
};

// Four neighbouring pixels in a block, of whose samples lane l has own[l].
struct Samples {
  const float* red = nullptr;  // of the first pixel
  std::ptrdiff_t pixel = 0;    // floats from one pixel to the next
  std::ptrdiff_t channel = 0;  // and from one channel to the next
  int before = 0;              // samples in earlier blocks
  Integers own = {};
};

// transpose_four() from sample `s` on where pixels have too few: zeros in their place.
[[gnu::always_inline]] inline void transpose_own(const Samples& in, const float* from, int s,
                                                 Floats* to) {
  for (int k = 0; k < kLanes; ++k) {
    for (int l = 0; l < kLanes; ++l)
      to[k][l] = s + k < in.own[l] ? from[l * in.pixel + s + k] : 0.0f;
  }
}

// Sample number n of every lane that `has` one.
template <bool kColours, bool kMasked>
[[gnu::always_inline]] inline void add(Lanes& lanes, const Doubles* values, const Integers& has,
                                       double n) {
  for (int c = kColours ? 0 : 3; c < 4; ++c) {
    const Doubles delta = values[c] - lanes.mean[c];
    const Doubles mean = lanes.mean[c] + delta / n;
    const Doubles m2 = lanes.m2[c] + delta * (values[c] - mean);
    lanes.mean[c] = kMasked ? (has ? mean : lanes.mean[c]) : mean;
    lanes.m2[c] = kMasked ? (has ? m2 : lanes.m2[c]) : m2;
  }
  const Doubles least = values[3] < lanes.minimum ? values[3] : lanes.minimum;
  const Doubles most = values[3] > lanes.maximum ? values[3] : lanes.maximum;
  lanes.minimum = kMasked ? (has ? least : lanes.minimum) : least;
  lanes.maximum = kMasked ? (has ? most : lanes.maximum) : most;
}

template <bool kColours, bool kMasked>
[[gnu::always_inline]] inline void add_four(Lanes& lanes, const Samples& in, int s, int end,
                                            double exposure) {
  Floats colours[3][kLanes];
  for (int c = 0; c < 3; ++c) {
    const float* from = in.red + c * in.channel;
    if (kMasked) {
      transpose_own(in, from, s, colours[c]);
    } else {
      transpose_four(from + s, in.pixel, colours[c]);
    }
  }
  for (int k = 0; k < (kMasked ? std::min(kLanes, end - s) : kLanes); ++k) {
    Doubles values[4];
    for (int c = 0; c < 3; ++c)
      values[c] = __builtin_convertvector(colours[c][k], Doubles);
    values[3] = exposure * (kLuminanceWeights[0] * values[0] + kLuminanceWeights[1] * values[1] +
                            kLuminanceWeights[2] * values[2]);
    const Integers has = in.own > static_cast<std::int64_t>(s + k);
    add<kColours, kMasked>(lanes, values, has, in.before + s + k + 1);
  }
}

// Lanes are independent of each other: wider vectors change no bit.
template <bool kColours>
SPOOL_VECTOR_CLONES void add_samples(const Samples& in, int least, int most, double exposure,
                                     Lanes* to) {
  Lanes lanes = *to;
  int s = 0;
  for (; s + kLanes <= least; s += kLanes)
    add_four<kColours, false>(lanes, in, s, most, exposure);
  for (; s < most; s += kLanes)
    add_four<kColours, true>(lanes, in, s, most, exposure);
  *to = lanes;
}

// A copy of a size that the compiler knows is a move.
void copy_lanes(void* to, const void* from, int pixels) {
  if (pixels == kLanes) {
    std::memcpy(to, from, sizeof(Doubles));
  } else {
    std::memcpy(to, from, sizeof(double) * static_cast<std::size_t>(pixels));
  }
}

// Copies what four pixels from `at` on have in the planes, to or from `lanes`.
template <class Copy>
void each_plane(const StatisticsPlanes& planes, Lanes& lanes, std::size_t at, const Copy& copy) {
  for (std::size_t c = 0; planes.mean != nullptr && c < 3; ++c) {
    copy(&(*planes.mean)[c][at], &lanes.mean[c]);
    copy(&(*planes.m2)[c][at], &lanes.m2[c]);
  }
  copy(&(*planes.signal_mean)[at], &lanes.mean[3]);
  copy(&(*planes.signal_m2)[at], &lanes.m2[3]);
  copy(&(*planes.signal_minimum)[at], &lanes.minimum);
  copy(&(*planes.signal_maximum)[at], &lanes.maximum);
}

}  // namespace

void add_block(const StatisticsPlanes& planes, double exposure, const BlockView& block,
               const CountImage& counts, int row_begin, int row_end) {
  const Rectangle& tile = block.pixels;
  for (int y = row_begin; y < row_end; ++y) {
    for (int x = tile.x0; x < tile.x1; x += kLanes) {
      const int pixels = std::min(kLanes, tile.x1 - x);
      Samples in{block.at(x, y), block.samples, static_cast<std::ptrdiff_t>(block.channel()),
                 block.first};
      std::int64_t own[kLanes] = {};
      int least = block.samples, most = 0;
      for (int l = 0; l < kLanes; ++l) {
        const int count =
            l < pixels ? std::clamp(counts(x + l, y) - block.first, 0, block.samples) : 0;
        own[l] = count;
        least = std::min(least, count);
        most = std::max(most, count);
      }
      std::memcpy(&in.own, own, sizeof(own));
      if (most == 0) continue;
      Lanes lanes{};
      const std::size_t at = counts.index(x, y);
      each_plane(planes, lanes, at,
                 [&](double* from, Doubles* to) { copy_lanes(to, from, pixels); });
      if (planes.mean != nullptr) {
        add_samples<true>(in, least, most, exposure, &lanes);
      } else {
        add_samples<false>(in, least, most, exposure, &lanes);
      }
      each_plane(planes, lanes, at,
                 [&](double* to, Doubles* from) { copy_lanes(to, from, pixels); });
    }
  }
}

}  // namespace spool
