// The analysis of a block of a board in float, all levels in one go (eqs 1-8).
//
// f_0, C^2 and what is fresh or closed in a block and around it are copied once; everything that
// follows from them is made in memory that a core's cache holds, and only f, A and P are kept. An
// entry depends on the board alone, not on the block that it is computed with: any cut into blocks,
// on any number of threads, gives the same bits. Slow twin, in double:
// tests/reference/multiscale_reference.h.
#pragma once

#include <span>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/rectangle.h"
#include "lib/pyramid/patch.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/pass_weights.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

class BlockAnalysis {
 public:
  // Both must outlive this.
  BlockAnalysis(EpochBoard& board, const MultiscaleOptions& options);

  // How far from a piece its samples are felt, in x and y alike.
  int reach() const { return reach_; }

  // f_1 .., A_1 .. and P_1 .. of the entries in `box`, d and V where the board has images for them;
  // A by what is fresh. Several threads may analyse different boxes.
  void update(const Rectangle& box, GuardCounts& guards) const;

  // A_0 of the pieces of `picks`, no other is touched by a step; before[scalar][i] is f_0 of
  // picks[i] before it.
  void update_pieces(std::span<const Pick> picks,
                     const std::vector<std::vector<float>>& before) const;

  // P = -infinity in `box` where every piece of a region is closed.
  void close(const Rectangle& box) const;

 private:
  // Per region of the entries in a box, at [k - 1]: samples taken in this step, and pieces that
  // were saturated before it. Empty where there are none.
  struct Counts {
    std::vector<Patch<std::int32_t>> fresh, closed;
  };

  int region_reach() const { return 1 << (options_.levels() - 1); }
  Counts counts_of(const Rectangle& box) const;
  std::vector<Patch<float>> variances(const ScalarAnalysis<float>& scalar,
                                      const Rectangle& box) const;
  Patch<float> predict(const Patch<float>& coarse, int k, const Rectangle& box) const;
  void attenuate(ScalarAnalysis<float>& scalar, int k, const Rectangle& box, const Counts& counts,
                 const Patch<float>& now) const;
  void prioritise(const ScalarAnalysis<float>& scalar, int k, const Rectangle& box,
                  const Patch<float>& variance, const Patch<float>& fine,
                  const Patch<float>& prediction, GuardCounts& guards) const;

  EpochBoard& board_;
  const MultiscaleOptions& options_;
  const PyramidOptions pyramid_;
  std::vector<PassWeights> weights_;  // [level]
  std::vector<int> margin_;           // of f_k around a box, at [k]
  int reach_ = 0;
};

}  // namespace spool
