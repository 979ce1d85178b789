#include "lib/sampling/multiscale/region_sampling.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/pyramid/region_mean.h"
#include "lib/sampling/piece_choice.h"

namespace spool {
namespace {

std::vector<OpenPiece> open_pieces(const Board& board, const Samples& samples,
                                   const Rectangle& region) {
  std::vector<OpenPiece> pieces;
  pieces.reserve(static_cast<std::size_t>(region.area()));
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (board.closed(x, y)) continue;
      const int gx = x + board.window.x0, gy = y + board.window.y0;
      pieces.push_back({samples.statistics.n(gx, gy), gx, gy});
    }
  }
  return pieces;
}

}  // namespace

Rectangle sampled_region(const Board& board, const RegionEntry& entry) {
  return intersect(region(entry.x, entry.y, entry.level, board.bounds()), board.area);
}

long long choose_pieces(Board& board, const Samples& samples, const SamplePool& pool,
                        const Rectangle& region, long long left, std::uint64_t seed,
                        const MultiscaleOptions& options, std::vector<Pick>& picks) {
  std::vector<OpenPiece> pieces = open_pieces(board, samples, region);
  const std::vector<PieceShare> shares =
      options.pop_samples
          ? to_least_sampled(pieces, pool, std::min<long long>(*options.pop_samples, left), seed)
          : one_each(std::move(pieces), left);
  long long chosen = 0;
  for (const PieceShare& share : shares) {
    const Pick pick{share.x - board.window.x0, share.y - board.window.y0, share.count};
    picks.push_back(pick);
    board.fresh(pick.x, pick.y) += pick.count;
    chosen += pick.count;
  }
  return chosen;
}

void take_picks(Board& board, Samples& samples, const SamplePool& pool,
                const std::vector<Pick>& picks, const MultiscaleOptions& options,
                GuardCounts& guards) {
  constexpr std::size_t kChunk = 256;  // picks; few enough to share out, many enough to be worth it
  const std::size_t chunks = (picks.size() + kChunk - 1) / kChunk;
  std::vector<GuardCounts> counts(chunks);
  parallel_for(chunks, [&](std::size_t c) {
    const std::size_t end = std::min(picks.size(), (c + 1) * kChunk);
    for (std::size_t i = c * kChunk; i < end; ++i) {
      const Pick& pick = picks[i];
      take(samples, pool, pick.x + board.window.x0, pick.y + board.window.y0, pick.count);
      load_piece(board, samples, pick.x, pick.y, options, counts[c]);
    }
  });
  for (const GuardCounts& chunk : counts)
    guards += chunk;
}

bool end_step(Board& board, const Samples& samples, const SamplePool& pool,
              const std::vector<Pick>& picks) {
  bool any_closed = false;
  for (const Pick& pick : picks) {
    board.fresh(pick.x, pick.y) = 0;
    const int gx = pick.x + board.window.x0, gy = pick.y + board.window.y0;
    if (samples.statistics.n(gx, gy) < pool.capacity(gx, gy)) continue;
    board.closed(pick.x, pick.y) = 1;
    ++board.closed_pieces;
    any_closed = true;
  }
  return any_closed;
}

}  // namespace spool
