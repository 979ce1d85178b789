// The means of the first samples of every pixel, made while a recording is read for the first time.
#pragma once

#include <optional>
#include <vector>

#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

class MeansPass : public FirstPass {
 public:
  // Of the first `spp` samples, of all but `holdout` where it is 0.
  MeansPass(int spp, int holdout) : spp_(spp), holdout_(holdout) {}

  void begin(const LayerGrid& grid) override;
  void see(const BlockRow& row) override;

  // The bits of prefix_means(); none where the pool's samples are not those that were seen, or it
  // has fewer.
  std::optional<PieceStatistics> taken(const SamplePool& pool) &&;

 private:
  int spp_, holdout_;
  int count_ = 0;                  // of every pixel
  std::vector<std::int32_t> own_;  // of a block's pixels in a row, by block: as many of each
  std::size_t row_width_ = 0;
  int block_spp_ = 1;
  RgbImage mean_;
};

}  // namespace spool
