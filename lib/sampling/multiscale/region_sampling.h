// Which pieces of a region are sampled, and taking those samples.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/region_queue.h"

namespace spool {

struct Pick {
  int x = 0, y = 0;  // of the window
  int count = 0;     // samples
};

// The region of an entry, clipped to what the board may sample.
Rectangle sampled_region(const Board& board, const RegionEntry& entry);

// Appends what a pop of `region` takes, at most `left` samples, and marks it in board.fresh;
// returns the number of samples. One for each unsaturated piece; when fewer are left, for the first
// in the order (n, y, x). With pop = fixed(m): m samples one by one to the least-sampled
// unsaturated piece, ties by a hash of `seed` and the piece.
long long choose_pieces(Board& board, const Samples& samples, const SamplePool& pool,
                        const Rectangle& region, long long left, std::uint64_t seed,
                        const MultiscaleOptions& options, std::vector<Pick>& picks);

// Picks of one step by y, then x, which is the order of the images that they touch: taking them is
// mostly waiting for memory. A piece is picked at most once a step, so no result depends on the
// order.
void sort_by_place(std::vector<Pick>& picks, const Rectangle& bounds);

// Takes the samples of all picks, in parallel where there are many, and loads the pieces.
void take_picks(Board& board, Samples& samples, const SamplePool& pool,
                const std::vector<Pick>& picks, const MultiscaleOptions& options,
                GuardCounts& guards);

// Ends a step: nothing is fresh, and what ran out is closed. True when something ran out.
bool end_step(Board& board, const Samples& samples, const SamplePool& pool,
              const std::vector<Pick>& picks);

}  // namespace spool
