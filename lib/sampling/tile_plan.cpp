#include "lib/sampling/tile_plan.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "lib/core/parallel.h"

#include "lib/core/check.h"

namespace spool {
namespace {

// Borders of the tiles along one axis: 0, tile, 2 tile, ..., n.
std::vector<int> borders(int n, int tile_size, int smallest) {
  std::vector<int> result = {0};
  for (int at = tile_size; at < n; at += tile_size) {
    if (n - at >= smallest) result.push_back(at);
  }
  result.push_back(n);
  return result;
}

}  // namespace

Result<std::vector<Rectangle>> plan_tiles(int width, int height, int tile_size, int smallest) {
  SPOOL_CHECK_GT(width, 0);
  SPOOL_CHECK_GT(height, 0);
  SPOOL_CHECK_GT(smallest, 0);
  if (tile_size == 0) return std::vector<Rectangle>{{0, 0, width, height}};
  if (tile_size < smallest || tile_size % smallest != 0) {
    return fail(ErrorCode::kUsage, "option tile: {} is not 0 or a multiple of 2^levels = {}",
                tile_size, smallest);
  }
  const std::vector<int> xs = borders(width, tile_size, smallest);
  const std::vector<int> ys = borders(height, tile_size, smallest);
  std::vector<Rectangle> tiles;
  for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
    for (std::size_t i = 0; i + 1 < xs.size(); ++i)
      tiles.push_back({xs[i], ys[j], xs[i + 1], ys[j + 1]});
  }
  return tiles;
}

void for_each_tile(const std::vector<long long>& budgets, bool parallel,
                   const std::function<void(std::size_t)>& run) {
  std::vector<std::size_t> order(budgets.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return budgets[a] > budgets[b]; });
  if (parallel) {
    std::atomic<std::size_t> next{0};
    parallel_for(order.size(), [&](std::size_t) { run(order[next++]); });
    return;
  }
  for (const std::size_t t : order)
    run(t);
}

}  // namespace spool
