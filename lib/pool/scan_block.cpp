#include "lib/pool/scan_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "lib/core/image.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

struct Counts {
  std::uint32_t nonfinite = 0, negative = 0, fireflies = 0;
};

// As integers floats of one sign have the order of their values, and NaN lies beyond infinity:
// comparisons of integers raise no exception and fill whole vectors.
constexpr std::uint32_t kMagnitude = 0x7FFFFFFFu;

SPOOL_VECTOR_CLONES void count_odd(const float* values, std::size_t n, std::int32_t largest,
                                   std::int32_t limit, Counts* counts) {
  const float *red = values, *green = values + n, *blue = values + 2 * n;
  std::uint32_t nonfinite = 0, negative = 0, fireflies = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto r = std::bit_cast<std::int32_t>(red[i]), g = std::bit_cast<std::int32_t>(green[i]),
               b = std::bit_cast<std::int32_t>(blue[i]);
    const std::int32_t magnitude = std::max({r & static_cast<std::int32_t>(kMagnitude),
                                             g & static_cast<std::int32_t>(kMagnitude),
                                             b & static_cast<std::int32_t>(kMagnitude)});
    const std::uint32_t odd = magnitude > largest;
    // The least of all integers is -0, which is not negative.
    constexpr std::int32_t kMinusZero = std::numeric_limits<std::int32_t>::min();
    const std::uint32_t below = ((r < 0) & (r != kMinusZero)) | ((g < 0) & (g != kMinusZero)) |
                                ((b < 0) & (b != kMinusZero));
    nonfinite += odd;
    negative += below & (1u - odd);
    fireflies += static_cast<std::uint32_t>(std::max({r, g, b}) > limit) & (1u - odd);
  }
  *counts = {nonfinite, negative, fireflies};
}

// The largest of the bits, where a sign makes any value large.
SPOOL_VECTOR_CLONES std::uint32_t largest_bits(const float* values, std::size_t n) {
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < n; ++i)
    largest = std::max(largest, std::bit_cast<std::uint32_t>(values[i]));
  return largest;
}

bool is_odd(const BlockView& block, const float* red) {
  return !is_ordinary({red[0], red[block.channel()], red[2 * block.channel()]});
}

// The largest float that a channel may have, as an integer.
std::int32_t bits_of_limit(double limit) {
  auto least = static_cast<float>(limit);
  if (static_cast<double>(least) > limit) least = std::nextafter(least, 0.0f);
  return std::bit_cast<std::int32_t>(least);
}

void name_nonfinite(const BlockView& block, SanitiseReport& report) {
  for (int y = block.pixels.y0; y < block.pixels.y1; ++y) {
    for (int x = block.pixels.x0; x < block.pixels.x1; ++x) {
      for (int s = 0; s < block.samples; ++s) {
        if (is_odd(block, block.at(x, y) + s)) report.add_nonfinite(x, y, block.first + s);
      }
    }
  }
}

bool keeps_sample(const BlockView& block, int x, int y) {
  for (int s = 0; s < block.samples; ++s) {
    if (!is_odd(block, block.at(x, y) + s)) return true;
  }
  return false;
}

}  // namespace

bool is_plain_row(const BlockRow& row, const SanitiseRules& rules) {
  const std::int32_t limit =
      std::min(std::bit_cast<std::int32_t>(kLargestRadiance), bits_of_limit(rules.firefly_limit));
  const auto n = static_cast<std::size_t>(row.block->pixels.width()) * row.block->samples;
  return largest_bits(row.values, n) <= static_cast<std::uint32_t>(std::max(limit, 0));
}

SanitiseReport scan_block(const BlockView& block, const SanitiseRules& rules) {
  Counts counts;
  count_odd(block.block.values, block.channel(), std::bit_cast<std::int32_t>(kLargestRadiance),
            bits_of_limit(rules.firefly_limit), &counts);
  SanitiseReport report;
  report.negative = counts.negative;
  report.fireflies = counts.fireflies;
  if (counts.nonfinite > 0) name_nonfinite(block, report);
  return report;
}

std::uint64_t count_empty_pixels(const LayerBlocks& radiance,
                                 const std::vector<SanitiseReport>& blocks) {
  const LayerGrid& grid = radiance.grid();
  std::uint64_t empty = 0;
  for (int t = 0; t < grid.tiles(); ++t) {
    const Rectangle tile = grid.tile(t);
    Image<std::uint8_t> kept(tile.width(), tile.height());
    for (int b = 0; b < grid.blocks(); ++b) {
      if (blocks[grid.index(t, b)].nonfinite == 0) {
        kept = Image<std::uint8_t>(tile.width(), tile.height(), 1);
        break;
      }
      const BlockView block = radiance.view(t, b);
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          if (keeps_sample(block, x, y)) kept(x - tile.x0, y - tile.y0) = 1;
        }
      }
    }
    empty += static_cast<std::uint64_t>(std::ranges::count(kept.pixels(), 0));
  }
  return empty;
}

}  // namespace spool
