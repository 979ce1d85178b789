#include "lib/sampling/multiscale/tile_budgets.h"

#include <algorithm>
#include <numeric>

#include "lib/core/pairwise_sum.h"
#include "lib/sampling/apportion.h"

namespace spool {
namespace {

// What a tile may still take.
long long room(const Rectangle& tile, const CountImage& n, const SamplePool& pool) {
  long long sum = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x)
      sum += pool.capacity(x, y) - n(x, y);
  }
  return sum;
}

// The sum of all priorities of a tile, in fixed order [LiuZheng (13)].
template <class T>
double tile_weight(const AnalysedBoard<T>& board, const Rectangle& tile) {
  double weight = 0.0;
  for (const Image<T>& priority : board.priority) {
    weight += pairwise_sum(static_cast<std::size_t>(tile.area()), [&](std::size_t i) {
      const int x = static_cast<int>(i) % tile.width(), y = static_cast<int>(i) / tile.width();
      return std::max<double>(priority(tile.x0 + x, tile.y0 + y),
                              0.0);  // -infinity: nothing to sample
    });
  }
  return weight;
}

}  // namespace

template <class T>
std::vector<long long> tile_budgets(const std::vector<Rectangle>& tiles,
                                    const AnalysedBoard<T>& image, const Samples& samples,
                                    const SamplePool& pool, long long left,
                                    const MultiscaleOptions& options) {
  const CountImage& n = samples.statistics.n;
  std::vector<double> weights;
  std::vector<long long> rooms;
  for (const Rectangle& tile : tiles) {
    weights.push_back(tile_weight(image, tile));
    rooms.push_back(room(tile, n, pool));
  }
  if (options.budget_base == BudgetBase::kAdaptive) return apportion(weights, left, rooms);
  // Of image; what a tile took before counts, and what it took too much is divided again.
  std::vector<long long> taken, capacity;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    long long sum = 0;
    for (int y = tiles[t].y0; y < tiles[t].y1; ++y) {
      for (int x = tiles[t].x0; x < tiles[t].x1; ++x)
        sum += n(x, y);
    }
    taken.push_back(sum);
    capacity.push_back(sum + rooms[t]);
  }
  const long long total = left + std::accumulate(taken.begin(), taken.end(), 0LL);
  const std::vector<long long> shares = apportion(weights, total, capacity);
  std::vector<double> wanted;
  for (std::size_t t = 0; t < tiles.size(); ++t)
    wanted.push_back(static_cast<double>(std::max(shares[t] - taken[t], 0LL)));
  return apportion(wanted, left, rooms);
}

template std::vector<long long> tile_budgets(const std::vector<Rectangle>&,
                                             const AnalysedBoard<double>&, const Samples&,
                                             const SamplePool&, long long,
                                             const MultiscaleOptions&);
template std::vector<long long> tile_budgets(const std::vector<Rectangle>&,
                                             const AnalysedBoard<float>&, const Samples&,
                                             const SamplePool&, long long,
                                             const MultiscaleOptions&);

}  // namespace spool
