#include "lib/sampling/multiscale/region_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lib/core/parallel.h"
#include "lib/core/parallel_count.h"
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

// Lets the memory begin with the statistics of a piece.
void ask_for(const Samples& samples, std::size_t piece) {
  const PieceStatistics& statistics = samples.statistics;
  for (std::size_t c = 0; c < 3; ++c) {
    __builtin_prefetch(&statistics.mean[c][piece], 1);
    __builtin_prefetch(&statistics.m2[c][piece], 1);
  }
  const ScalarStatistics& analysis = statistics.analysis;
  for (const Plane* plane : {&analysis.mean, &analysis.m2, &analysis.minimum, &analysis.maximum})
    __builtin_prefetch(&(*plane)[piece], 1);
}

}  // namespace

Rectangle sampled_region(const Board& board, const RegionEntry& entry) {
  return intersect(region(entry.x, entry.y, entry.level, board.bounds()), board.area);
}

int predicted_count(double priority, double lowest) {
  if (!(lowest > 0.0)) return 1;
  // Written so that NaN, of two infinite priorities, gives 1.
  const double predicted = std::max(1.0, std::sqrt(priority / lowest));
  return static_cast<int>(std::min(predicted, double{kMostPredicted}));
}

int offered(const Board& board, const Samples& samples, const SamplePool& pool, int x, int y,
            int each) {
  if (each == 1) return 1;
  const int gx = x + board.window.x0, gy = y + board.window.y0;
  return std::min(each, pool.capacity(gx, gy) - samples.statistics.n(gx, gy));
}

long long offered(const Board& board, const Samples& samples, const SamplePool& pool,
                  const Rectangle& region, int each) {
  if (each == 1 && board.closed_pieces == 0) return region.area();
  long long sum = 0;
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x)
      sum += board.closed(x, y) ? 0 : offered(board, samples, pool, x, y, each);
  }
  return sum;
}

long long choose_pieces(Board& board, const Samples& samples, const SamplePool& pool,
                        const Rectangle& region, int each, long long left,
                        std::vector<Pick>& picks) {
  long long chosen = 0;
  const auto pick = [&](int x, int y, int count) {
    picks.push_back({x, y, count});
    board.fresh(x, y) = static_cast<std::uint8_t>(count);
    chosen += count;
  };
  if (region.area() > left) {
    std::vector<OpenPiece> pieces = open_pieces(board, samples, region);
    keep_first(pieces, left);
    for (const OpenPiece& piece : pieces)
      pick(piece.x - board.window.x0, piece.y - board.window.y0, 1);
    return chosen;
  }
  const auto most = static_cast<int>(std::min<long long>(each, left / region.area()));
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!board.closed(x, y)) pick(x, y, offered(board, samples, pool, x, y, most));
    }
  }
  return chosen;
}

std::vector<Pick> choose_uniformly(const Board& board, const Samples& samples,
                                   const SamplePool& pool, long long left, std::uint64_t seed) {
  const Rectangle area = {board.area.x0 + board.window.x0, board.area.y0 + board.window.y0,
                          board.area.x1 + board.window.x0, board.area.y1 + board.window.y0};
  const CountImage& n = samples.statistics.n;
  const CountImage raised = raise_least_sampled(n, pool, area, left, seed);
  std::vector<Pick> picks;
  for (int y = 0; y < area.height(); ++y) {
    for (int x = 0; x < area.width(); ++x) {
      const int count = raised(x, y) - n(x + area.x0, y + area.y0);
      if (count > 0) picks.push_back({x + board.area.x0, y + board.area.y0, count});
    }
  }
  return picks;
}

template <class T>
void take_picks(AnalysedBoard<T>& board, Samples& samples, const SamplePool& pool,
                const std::vector<Pick>& picks, const MultiscaleOptions& options,
                GuardCounts& guards) {
  constexpr std::size_t kChunk = 256;  // picks; few enough to share out, many enough to be worth it
  const std::size_t chunks = (picks.size() + kChunk - 1) / kChunk;
  const int x0 = board.window.x0, y0 = board.window.y0;
  const CountImage& n = samples.statistics.n;
  std::vector<GuardCounts> counts(chunks);
  parallel_for(chunks, [&](std::size_t c) {
    // First the next sample of every piece, then what follows from it: a sample is three reads far
    // apart, for which one processor can wait many times at once if nothing stands between them.
    std::array<Rgb, kChunk> first;
    const auto chunk =
        std::span(picks).subspan(c * kChunk, std::min(kChunk, picks.size() - c * kChunk));
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      const int x = chunk[i].x + x0, y = chunk[i].y + y0;
      first[i] = pool.sample(x, y, n(x, y));
      ask_for(samples, n.index(x, y));
    }
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      const Pick& pick = chunk[i];
      const int x = pick.x + x0, y = pick.y + y0;
      SPOOL_CHECK_LE(n(x, y) + pick.count, pool.capacity(x, y));
      add_sample(samples, n.index(x, y), first[i]);
      take(samples, pool, x, y, pick.count - 1);
      load_piece(board, samples, pick.x, pick.y, options, counts[c]);
    }
  });
  for (const GuardCounts& chunk : counts)
    guards += chunk;
}

void end_step(Board& board, const Samples& samples, const SamplePool& pool,
              const std::vector<Pick>& picks) {
  constexpr std::size_t kChunk = 4096;  // picks; a piece is picked once
  board.closed_pieces += parallel_count<long long>(
      picks.size(),
      [&](std::size_t i) {
        const Pick& pick = picks[i];
        board.fresh(pick.x, pick.y) = 0;
        const int gx = pick.x + board.window.x0, gy = pick.y + board.window.y0;
        const bool ran_out = samples.statistics.n(gx, gy) >= pool.capacity(gx, gy);
        if (ran_out) board.closed(pick.x, pick.y) = 1;
        return ran_out;
      },
      kChunk);
}

template void take_picks(AnalysedBoard<double>&, Samples&, const SamplePool&,
                         const std::vector<Pick>&, const MultiscaleOptions&, GuardCounts&);
template void take_picks(AnalysedBoard<float>&, Samples&, const SamplePool&,
                         const std::vector<Pick>&, const MultiscaleOptions&, GuardCounts&);

}  // namespace spool
