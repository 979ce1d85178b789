// The values of a layer with a value per sample (radiance, film positions), block after block.
//
// A block lies where it is for good (a mapped file, or memory), or is read whenever it is asked
// for. Values are the same either way; from any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/rectangle.h"

namespace spool {

// How the samples of a layer are cut into blocks: tile t covers tile_size^2 pixels (cropped at the
// right and bottom, row after row), and its block b holds the samples [b * block_spp, ...) of each
// of them as [c][y][x][s] floats.
struct LayerGrid {
  int width = 0, height = 0, spp = 0;
  int tile_size = 0;  // pixels
  int block_spp = 0;  // samples

  int tiles_x() const { return (width + tile_size - 1) / tile_size; }
  int tiles_y() const { return (height + tile_size - 1) / tile_size; }
  int tiles() const { return tiles_x() * tiles_y(); }
  int blocks() const { return (spp + block_spp - 1) / block_spp; }  // of a tile
  std::size_t count() const { return static_cast<std::size_t>(tiles()) * blocks(); }
  std::size_t index(int tile, int block) const {
    return static_cast<std::size_t>(tile) * blocks() + block;
  }

  Rectangle tile(int t) const {
    const int x = t % tiles_x() * tile_size, y = t / tiles_x() * tile_size;
    return {x, y, std::min(x + tile_size, width), std::min(y + tile_size, height)};
  }
  int first_sample(int block) const { return block * block_spp; }
  int samples(int block) const { return std::min(block_spp, spp - block * block_spp); }
};

// The values [c][y][x][s] of one block. `held` keeps them; where it is null they lie there as long
// as their source.
struct BlockValues {
  const float* values = nullptr;
  std::shared_ptr<const void> held;
};

// Gives the block of an index of LayerGrid, from any thread, as often as it is asked for.
using BlockReader = std::function<Result<BlockValues>(std::size_t block)>;

// One block and where it belongs; lives as long as the view and its layer.
struct BlockView {
  std::size_t index = 0;  // of LayerGrid
  Rectangle pixels;
  int first = 0, samples = 0;
  BlockValues block;

  // From one channel to the next, in floats.
  std::size_t channel() const { return static_cast<std::size_t>(pixels.area()) * samples; }
  // The samples of a pixel, in the first channel.
  const float* at(int x, int y) const {
    const auto pixel = static_cast<std::size_t>(y - pixels.y0) * pixels.width() + (x - pixels.x0);
    return block.values + pixel * samples;
  }
};

// A row of a channel of a block, in the processor's cache.
struct BlockRow {
  const BlockView* block = nullptr;  // without values
  int channel = 0, y = 0;            // of the layer, of the picture
  const float* values = nullptr;     // [x][s]
};
using RowLook = std::function<void(const BlockRow&)>;

// Reads a block as a BlockReader does, for the first time, and shows its values [c][y][x][s] in
// pieces of `piece` floats, in their order; what is left at the end is shorter.
using PieceLook = std::function<void(const float* values, std::size_t first)>;
enum class Again { kExpected, kNotExpected };  // whether the block will be looked at later
using PieceReader = std::function<Result<BlockValues>(std::size_t block, std::size_t piece, Again,
                                                      const PieceLook&)>;

class LayerBlocks {
 public:
  LayerBlocks() = default;
  // Without `pieces` a block is read as a whole before its rows are looked at.
  LayerBlocks(const LayerGrid& grid, int channels, BlockReader reader, PieceReader pieces = {});

  // How all blocks are read once.
  struct Reading {
    bool keep = false;     // blocks that do not lie where they are for good, too
    RowLook row = {};      // of every block, in the order c, y
    bool by_tile = false;  // blocks of a tile in their order, on one thread
    Again again = Again::kExpected;
  };
  // Reads every block once, in parallel, and calls `look` with each, after its rows. Errors: the
  // first one, by index.
  Result<void> read_all(const Reading& reading,
                        const std::function<Result<void>(const BlockView&)>& look);

  const LayerGrid& grid() const { return grid_; }
  // Every block lies in memory or in a mapped file: any order of reading costs the same.
  bool in_place() const { return in_place_; }

  // A block that cannot be read a second time holds zeros, and failure() says why.
  BlockView view(int tile, int block) const;
  Result<void> failure() const;

  // Where a sample lies in the first channel; `channel` floats further the next one. Until the
  // next call from the same thread.
  struct Place {
    const float* value;
    std::size_t channel;
  };
  Place place_of(int x, int y, int s) const {
    const int size = grid_.tile_size;
    const int tx = x / size, ty = y / size, b = s / grid_.block_spp;
    const int tile_width = std::min(size, grid_.width - tx * size);
    const int tile_height = std::min(size, grid_.height - ty * size);
    const int count = std::min(grid_.block_spp, grid_.spp - b * grid_.block_spp);
    const std::size_t index = (static_cast<std::size_t>(ty) * tiles_x_ + tx) * blocks_ + b;
    const float* block = kept_[index].values;
    if (block == nullptr) [[unlikely]]
      block = read_again(index);
    const std::size_t pixel =
        static_cast<std::size_t>(y - ty * size) * tile_width + (x - tx * size);
    return {block + pixel * count + (s - b * grid_.block_spp),
            static_cast<std::size_t>(tile_width) * tile_height * count};
  }

 private:
  // The first error of reading again; shared, so that a layer can be moved.
  struct Failure {
    std::mutex mutex;
    std::optional<Error> first;
  };

  BlockView view_of(std::size_t index, BlockValues values) const;
  Result<BlockValues> read_first(std::size_t index, const Reading& reading) const;
  BlockValues values_of(std::size_t index) const;
  const float* read_again(std::size_t index) const;

  LayerGrid grid_;
  int channels_ = 0, tiles_x_ = 0, blocks_ = 0;
  std::uint64_t identity_ = 0;  // of what a thread remembers
  BlockReader reader_;
  PieceReader pieces_;             // may be empty
  std::vector<BlockValues> kept_;  // by index; null where a block is read when asked for
  bool in_place_ = false;
  std::shared_ptr<Failure> failure_;
};

}  // namespace spool
