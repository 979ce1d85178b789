#include "lib/pool/layer_blocks.h"

#include <algorithm>
#include <array>
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

LayerBlocks::LayerBlocks(const LayerGrid& grid, int channels, BlockReader reader)
    : grid_(grid), channels_(channels), reader_(std::move(reader)) {
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

Result<void> LayerBlocks::read_all(bool keep,
                                   const std::function<Result<void>(const BlockView&)>& look) {
  std::vector<Result<void>> looked(kept_.size());
  parallel_for(kept_.size(), [&](std::size_t i) {
    Result<BlockValues> read = reader_(i);
    if (!read) {
      looked[i] = tl::unexpected(std::move(read).error());
      return;
    }
    if (keep || read->held == nullptr) kept_[i] = *read;
    looked[i] = look(view_of(i, std::move(*read)));
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
