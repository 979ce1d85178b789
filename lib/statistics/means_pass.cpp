#include "lib/statistics/means_pass.h"

#include <algorithm>
#include <utility>

#include "lib/statistics/block_means.h"

namespace spool {

void MeansPass::begin(const LayerGrid& grid) {
  const int all = std::max(grid.spp - holdout_, 0);
  count_ = spp_ == 0 ? all : std::min(spp_, all);
  mean_ = make_rgb(grid.width, grid.height);
  row_width_ = static_cast<std::size_t>(std::min(grid.tile_size, grid.width));
  for (int b = 0; b < grid.blocks(); ++b) {
    const int own = std::clamp(count_ - grid.first_sample(b), 0, grid.samples(b));
    own_.insert(own_.end(), row_width_, own);
  }
  block_spp_ = grid.block_spp;
}

void MeansPass::see(const BlockRow& row) {
  const BlockView& block = *row.block;
  const auto number = static_cast<std::size_t>(block.first / block_spp_);
  add_means(row.values, block.samples, own_.data() + number * row_width_, block.pixels.width(),
            block.first, &mean_[static_cast<std::size_t>(row.channel)](block.pixels.x0, row.y));
}

std::optional<PieceStatistics> MeansPass::taken(const SamplePool& pool) && {
  if (mean_[0].empty() || !pool.as_recorded() || pool.capacity(0, 0) < count_ ||
      (spp_ > 0 && count_ < spp_))
    return std::nullopt;
  return means_of(1, CountImage(pool.width(), pool.height(), count_), std::move(mean_));
}

}  // namespace spool
