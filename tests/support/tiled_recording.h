// The samples of a recording in memory, cut into tiles and blocks as a file has them.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "lib/pool/recorded_samples.h"

namespace spool::test {

using CutBlocks =
    std::shared_ptr<std::vector<std::vector<float>>>;  // [tile][block] of [c][y][x][s]

inline CutBlocks cut_blocks(const RecordedSamples& whole, const LayerGrid& grid) {
  auto blocks = std::make_shared<std::vector<std::vector<float>>>();
  for (int t = 0; t < grid.tiles(); ++t) {
    const Rectangle tile = grid.tile(t);
    for (int b = 0; b < grid.blocks(); ++b) {
      std::vector<float>& values = blocks->emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        for (int y = tile.y0; y < tile.y1; ++y) {
          for (int x = tile.x0; x < tile.x1; ++x) {
            for (int s = 0; s < grid.samples(b); ++s)
              values.push_back(whole.raw_radiance(x, y, grid.first_sample(b) + s)[c]);
          }
        }
      }
    }
  }
  return blocks;
}

enum class Kept { kInPlace, kReadAgain };

// Gives blocks where they lie, or a copy each time it is asked.
inline BlockReader reader_of(CutBlocks blocks, Kept kept) {
  return [blocks = std::move(blocks), kept](std::size_t i) -> Result<BlockValues> {
    const std::vector<float>& block = blocks->at(i);
    if (kept == Kept::kInPlace) return BlockValues{block.data(), nullptr};
    const auto copy = std::make_shared<const std::vector<float>>(block);
    return BlockValues{copy->data(), copy};
  };
}

inline std::shared_ptr<const RecordedSamples> tiled_recording(const RecordedSamples& whole,
                                                              int tile_size, int block_spp,
                                                              Kept kept,
                                                              const SanitiseRules& rules = {}) {
  const LayerGrid grid{whole.width(), whole.height(), whole.spp(), tile_size, block_spp};
  LayerBlocks radiance(grid, 3, reader_of(cut_blocks(whole, grid), kept));
  auto recording = RecordedSamples::create("tiled", std::move(radiance), false, rules);
  return recording ? std::make_shared<const RecordedSamples>(std::move(*recording)) : nullptr;
}

}  // namespace spool::test
