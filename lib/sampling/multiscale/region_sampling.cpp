#include "lib/sampling/multiscale/region_sampling.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "lib/pyramid/region_mean.h"

namespace spool {
namespace {

struct Piece {
  int n = 0;  // samples it has
  int x = 0, y = 0;
};

std::vector<Piece> open_pieces(const Board& board, const Samples& samples,
                               const Rectangle& region) {
  std::vector<Piece> pieces;
  pieces.reserve(static_cast<std::size_t>(region.area()));
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (board.closed(x, y)) continue;
      pieces.push_back({samples.statistics.n(x + board.window.x0, y + board.window.y0), x, y});
    }
  }
  return pieces;
}

void pick(Board& board, const Piece& piece, int count, std::vector<Pick>& picks) {
  picks.push_back({piece.x, piece.y, count});
  board.fresh(piece.x, piece.y) += count;
}

long long choose_one_each(Board& board, std::vector<Piece> pieces, long long left,
                          std::vector<Pick>& picks) {
  if (static_cast<long long>(pieces.size()) > left) {
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
      return std::tie(a.n, a.y, a.x) < std::tie(b.n, b.y, b.x);
    });
    pieces.resize(static_cast<std::size_t>(left));
  }
  for (const Piece& piece : pieces)
    pick(board, piece, 1, picks);
  return static_cast<long long>(pieces.size());
}

long long choose_least_sampled(Board& board, const SamplePool& pool,
                               const std::vector<Piece>& pieces, long long wanted,
                               std::uint64_t seed, std::vector<Pick>& picks) {
  using Candidate = std::tuple<int, std::uint64_t, std::size_t>;  // samples, tie, which
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> waiting;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const int gx = pieces[i].x + board.window.x0, gy = pieces[i].y + board.window.y0;
    waiting.emplace(pieces[i].n, mix(seed, gx, gy), i);
  }
  std::vector<int> given(pieces.size(), 0);
  long long chosen = 0;
  for (; chosen < wanted && !waiting.empty(); ++chosen) {
    const auto [n, tie, i] = waiting.top();
    waiting.pop();
    ++given[i];
    const int gx = pieces[i].x + board.window.x0, gy = pieces[i].y + board.window.y0;
    if (n + 1 < pool.capacity(gx, gy)) waiting.emplace(n + 1, tie, i);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (given[i] > 0) pick(board, pieces[i], given[i], picks);
  }
  return chosen;
}

}  // namespace

Rectangle sampled_region(const Board& board, const RegionEntry& entry) {
  return intersect(region(entry.x, entry.y, entry.level, board.bounds()), board.area);
}

long long choose_pieces(Board& board, const Samples& samples, const SamplePool& pool,
                        const Rectangle& region, long long left, std::uint64_t seed,
                        const MultiscaleOptions& options, std::vector<Pick>& picks) {
  std::vector<Piece> pieces = open_pieces(board, samples, region);
  if (!options.pop_samples) return choose_one_each(board, std::move(pieces), left, picks);
  const long long wanted = std::min<long long>(*options.pop_samples, left);
  return choose_least_sampled(board, pool, pieces, wanted, seed, picks);
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
