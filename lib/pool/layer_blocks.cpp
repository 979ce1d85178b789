#include "lib/pool/layer_blocks.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "lib/core/check.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

// The block that a thread asked for last, of layers with even and odd identities: radiance and film
// positions are read in turn.
struct Remembered {
  std::uint64_t layer = 0;  // 0: none
  std::size_t block = 0;
  BlockValues values;
};
thread_local std::array<Remembered, 2> remembered;

std::uint64_t next_identity() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

LayerBlocks::LayerBlocks(const LayerGrid& grid, int channels, BlockReader reader,
                         PieceReader pieces)
    : grid_(grid), channels_(channels), reader_(std::move(reader)), pieces_(std::move(pieces)) {
  SPOOL_CHECK_GT(grid.width, 0);
  SPOOL_CHECK_GT(grid.height, 0);
  SPOOL_CHECK_GT(grid.spp, 0);
  SPOOL_CHECK_GT(grid.tile_size, 0);
  SPOOL_CHECK_GT(grid.block_spp, 0);
  tiles_x_ = grid.tiles_x();
  blocks_ = grid.blocks();
  identity_ = next_identity();
  kept_.resize(grid.count());
  failure_ = std::make_shared<Failure>();
}

Result<BlockValues> LayerBlocks::read_first(std::size_t index, const Reading& reading) const {
  if (!reading.row) return reader_(index);
  const BlockView place = view_of(index, {});
  const std::size_t width = static_cast<std::size_t>(place.pixels.width()) * place.samples;
  const auto show = [&](const float* values, std::size_t first) {
    const std::size_t row = first / width, height = static_cast<std::size_t>(place.pixels.height());
    reading.row({&place, static_cast<int>(row / height),
                 place.pixels.y0 + static_cast<int>(row % height), values});
  };
  if (pieces_) return pieces_(index, width, reading.again, show);
  SPOOL_ASSIGN(BlockValues read, reader_(index));
  for (std::size_t first = 0; first < channels_ * place.channel(); first += width)
    show(read.values + first, first);
  return read;
}

Result<void> LayerBlocks::read_all(const Reading& reading,
                                   const std::function<Result<void>(const BlockView&)>& look) {
  std::vector<Result<void>> looked(kept_.size());
  const auto read_one = [&](std::size_t i) {
    Result<BlockValues> read = read_first(i, reading);
    if (!read) {
      looked[i] = tl::unexpected(std::move(read).error());
      return;
    }
    if (reading.keep || read->held == nullptr) kept_[i] = *read;
    looked[i] = look(view_of(i, std::move(*read)));
  };
  const auto in_turn = static_cast<std::size_t>(reading.by_tile ? blocks_ : 1);
  parallel_for(kept_.size() / in_turn, [&](std::size_t group) {
    for (std::size_t i = group * in_turn; i < (group + 1) * in_turn; ++i)
      read_one(i);
  });
  for (Result<void>& block : looked)
    SPOOL_TRY(std::move(block));
  in_place_ = std::ranges::all_of(kept_, [](const auto& block) { return block.values != nullptr; });
  return {};
}

BlockView LayerBlocks::view(int tile, int block) const {
  const std::size_t index = grid_.index(tile, block);
  return view_of(index, kept_[index].values != nullptr ? kept_[index] : values_of(index));
}

Result<void> LayerBlocks::failure() const {
  if (failure_ == nullptr) return {};
  const std::scoped_lock lock(failure_->mutex);
  if (failure_->first) return tl::unexpected(*failure_->first);
  return {};
}

BlockView LayerBlocks::view_of(std::size_t index, BlockValues values) const {
  const int block = static_cast<int>(index % blocks_);
  return {index, grid_.tile(static_cast<int>(index / blocks_)), grid_.first_sample(block),
          grid_.samples(block), std::move(values)};
}

BlockValues LayerBlocks::values_of(std::size_t index) const {
  Result<BlockValues> read = reader_(index);
  if (read) return std::move(*read);
  {
    const std::scoped_lock lock(failure_->mutex);
    if (!failure_->first) failure_->first = std::move(read).error();
  }
  const BlockView place = view_of(index, {});
  const auto zeros = std::make_shared<const std::vector<float>>(channels_ * place.channel());
  return {zeros->data(), zeros};
}

const float* LayerBlocks::read_again(std::size_t index) const {
  Remembered& last = remembered[identity_ % remembered.size()];
  if (last.layer != identity_ || last.block != index) {
    last = {};  // before another takes its place in memory
    last = {identity_, index, values_of(index)};
  }
  return last.values.values;
}

}  // namespace spool
