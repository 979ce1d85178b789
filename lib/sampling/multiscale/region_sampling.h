// Which pieces of a region are sampled, and taking those samples.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/priority_maxima.h"

namespace spool {

struct Pick {
  int x = 0, y = 0;  // of the window
  int count = 0;     // samples
};

// The region of an entry, clipped to what the board may sample.
Rectangle sampled_region(const Board& board, const RegionEntry& entry);

// The most that predicted_count() says.
inline constexpr int kMostPredicted = 8;

// Samples of each piece of a region in one step: floor(sqrt(priority / lowest)), 1 .. 8, where
// `lowest` > 0 is the smallest priority that a region of the last step had. A region of four times
// the priority would have been taken about twice before the others are reached, because a pass
// lowers its attenuation and the variance of its mean alike. `lowest` = 0, before the second
// step: 1.
int predicted_count(double priority, double lowest);

// What an unsaturated piece gives when it is asked for `each` samples; of a region, all its pieces.
int offered(const Board& board, const Samples& samples, const SamplePool& pool, int x, int y,
            int each);
long long offered(const Board& board, const Samples& samples, const SamplePool& pool,
                  const Rectangle& region, int each);

// Appends what a pop of `region` takes, at most `left` samples, and marks it in board.fresh;
// returns the number of samples. `each` >= 1 for each unsaturated piece, as far as it has so many;
// fewer where `left` does not allow it, and of one each when fewer are left for the first in the
// order (n, y, x).
long long choose_pieces(Board& board, const Samples& samples, const SamplePool& pool,
                        const Rectangle& region, int each, long long left,
                        std::vector<Pick>& picks);

// What `left` samples take when no region has a priority: least-sampled pieces first, ties by a
// hash of `seed` and the piece.
std::vector<Pick> choose_uniformly(const Board& board, const Samples& samples,
                                   const SamplePool& pool, long long left, std::uint64_t seed);

// Takes the samples of all picks, in parallel where there are many, and loads the pieces.
template <class T>
void take_picks(AnalysedBoard<T>& board, Samples& samples, const SamplePool& pool,
                const std::vector<Pick>& picks, const MultiscaleOptions& options,
                GuardCounts& guards);

// Ends a step: nothing is fresh, and what ran out is closed.
void end_step(Board& board, const Samples& samples, const SamplePool& pool,
              const std::vector<Pick>& picks);

}  // namespace spool
