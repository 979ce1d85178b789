#include "lib/sampling/adaptive_wavelet.h"

#include <algorithm>
#include <cmath>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/sampling/piece_choice.h"
#include "lib/sampling/priority_order.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "lib/sampling/uniform.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr double kRelativeFloor = 0.01;  // in squared units of the exposed signal

// Sums and energies of the blocks of one level; block (x, y) covers 2^k pieces per side.
struct BlockLevel {
  Plane mean;      // Ybar
  Plane variance;  // sum of v
  Plane energy;    // w_H^2 + w_V^2 + w_D^2; none of pieces
};

// Kept from epoch to epoch. The image is mirrored up to whole blocks of the highest level.
struct BlockTree {
  std::vector<BlockLevel> levels;
  std::vector<Plane> priorities;  // [level][y][x] of the blocks that lie in the grid
};

BlockTree empty_tree(const Rectangle& grid, int levels) {
  BlockTree tree;
  const auto whole = [&](int size) { return (size + (1 << levels) - 1) >> levels; };
  const int across = whole(grid.width()), down = whole(grid.height());
  for (int k = 0; k <= levels; ++k) {
    const int width = across << (levels - k), height = down << (levels - k), side = 1 << k;
    tree.levels.push_back(
        {Plane(width, height), Plane(width, height), k == 0 ? Plane() : Plane(width, height)});
    tree.priorities.emplace_back((grid.width() + side - 1) / side,
                                 (grid.height() + side - 1) / side);
  }
  return tree;
}

void load_pieces(const PieceStatistics& statistics, const Plane& v, BlockLevel& level) {
  parallel_rows(0, level.mean.height(), [&](int y) {
    for (int x = 0; x < level.mean.width(); ++x) {
      const int px = extend_symmetric(x, v.width()), py = extend_symmetric(y, v.height());
      level.mean(x, y) = statistics.analysis.mean(px, py);
      // No reason to sample: a piece without samples has none to offer, a flat one only its floor.
      const bool flat = v(px, py) <= variance_floor(level.mean(x, y));
      level.variance(x, y) = statistics.n(px, py) == 0 || flat ? 0.0 : v(px, py);
    }
  });
}

void merge_blocks(const BlockLevel& fine, int k, BlockLevel& level) {
  const double scale = std::ldexp(0.5, k - 1);  // children's s = 2^(k-1) mean, w = sum / 2
  parallel_rows(0, level.mean.height(), [&](int y) {
    for (int x = 0; x < level.mean.width(); ++x) {
      const double a = fine.mean(2 * x, 2 * y), b = fine.mean(2 * x + 1, 2 * y);
      const double c = fine.mean(2 * x, 2 * y + 1), d = fine.mean(2 * x + 1, 2 * y + 1);
      const double h = scale * ((a + c) - (b + d));
      const double v = scale * ((a + b) - (c + d));
      const double diagonal = scale * ((a + d) - (b + c));
      level.mean(x, y) = 0.25 * ((a + b) + (c + d));
      level.variance(x, y) =
          (fine.variance(2 * x, 2 * y) + fine.variance(2 * x + 1, 2 * y)) +
          (fine.variance(2 * x, 2 * y + 1) + fine.variance(2 * x + 1, 2 * y + 1));
      level.energy(x, y) = h * h + v * v + diagonal * diagonal;
    }
  });
}

// `pieces` of a block: 4^k.
double block_priority(const BlockLevel& level, int k, double pieces, int x, int y,
                      WaveletPriority priority) {
  const double variance = level.variance(x, y) / pieces;
  const double above = k == 0 ? 0.0 : std::max(0.0, level.energy(x, y) - 4.0 * variance) / pieces;
  const double mean = level.mean(x, y);
  const double scale = priority == WaveletPriority::kRelative ? mean * mean + kRelativeFloor : 1.0;
  return (variance + above) / scale;
}

Rectangle block_of(const RegionEntry& entry, const Rectangle& grid) {
  const int side = 1 << entry.level;
  return intersect({entry.x * side, entry.y * side, (entry.x + 1) * side, (entry.y + 1) * side},
                   grid);
}

void update_tree(const PieceStatistics& statistics, const AdaptiveWaveletOptions& options,
                 GuardCounts& guards, BlockTree& tree) {
  const Plane v = analysis_variance(statistics, {}, guards);
  for (int k = 0; k <= options.levels; ++k) {
    BlockLevel& level = tree.levels[static_cast<std::size_t>(k)];
    Plane& priority = tree.priorities[static_cast<std::size_t>(k)];
    if (k == 0) {
      load_pieces(statistics, v, level);
    } else {
      merge_blocks(tree.levels[static_cast<std::size_t>(k) - 1], k, level);
    }
    const double pieces = std::ldexp(1.0, 2 * k);
    parallel_rows(0, priority.height(), [&](int y) {
      for (int x = 0; x < priority.width(); ++x)
        priority(x, y) = block_priority(level, k, pieces, x, y, options.priority);
    });
  }
}

void open_pieces(const Rectangle& block, const CountImage& n, const SamplePool& pool,
                 std::vector<OpenPiece>& pieces) {
  pieces.clear();
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      if (n(x, y) < pool.capacity(x, y)) pieces.push_back({n(x, y), x, y});
    }
  }
}

// Samples of one epoch: the best blocks that do not overlap, until `share` is reached. Nothing when
// no block has a priority.
CountImage choose_epoch(const PieceStatistics& statistics, const SamplePool& pool, long long share,
                        long long left, const std::vector<Plane>& priorities, SamplingLog& log) {
  const Rectangle grid = statistics.n.bounds();
  CountImage extra(grid.x1, grid.y1), taken(grid.x1, grid.y1);
  const auto is_free = [&](const RegionEntry& entry) {
    const Rectangle block = block_of(entry, grid);
    for (int y = block.y0; y < block.y1; ++y) {
      const std::int32_t* row = &taken(0, y);
      if (std::any_of(row + block.x0, row + block.x1, [](std::int32_t t) { return t != 0; }))
        return false;
    }
    return true;
  };
  const PriorityMaxima<double> maxima(priorities, 0);
  PriorityOrder<double> order(maxima, static_cast<std::size_t>(share) / 2, is_free);
  std::vector<OpenPiece> pieces;
  long long chosen = 0;
  while (chosen < share) {
    const std::optional<RegionEntry> found = order.next();
    if (!found) break;
    const RegionEntry& entry = *found;
    const Rectangle block = block_of(entry, grid);
    open_pieces(block, statistics.n, pool, pieces);
    if (pieces.empty()) continue;  // saturated
    keep_first(pieces, left - chosen);
    for (const OpenPiece& piece : pieces)
      ++extra(piece.x, piece.y);
    const auto count = static_cast<long long>(pieces.size());
    chosen += count;
    log.samples_of_level[static_cast<std::size_t>(entry.level)] += count;
    for (int y = block.y0; y < block.y1; ++y) {
      for (int x = block.x0; x < block.x1; ++x)
        taken(x, y) = 1;
    }
  }
  return extra;
}

}  // namespace

const OptionTable<AdaptiveWaveletOptions>& adaptive_wavelet_option_table() {
  using O = AdaptiveWaveletOptions;
  static const OptionTable<O> table = {
      init_spp_option<O>(&O::init_spp),
      integer_option<O>("levels", &O::levels, 0, 8, "levels of the block tree"),
      choice_option<O, WaveletPriority>(
          "priority", &O::priority,
          {{"relative", WaveletPriority::kRelative}, {"absolute", WaveletPriority::kAbsolute}},
          "error relative to the block's mean, or absolute"),
      integer_option<O>("epochs", &O::epochs, 1, 1000000,
                        "steps; as many as there are samples: one block each"),
  };
  return table;
}

Result<SamplingResult> sample_adaptive_wavelet(const SamplePool& pool, long long budget,
                                               const AdaptiveWaveletOptions& options,
                                               const SamplingContext& context) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  Spending spending =
      begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed));
  const PieceStatistics& statistics = spending.statistics;
  const long long& left = spending.left;
  SamplingLog& log = spending.log;
  log.samples_of_level.assign(static_cast<std::size_t>(options.levels) + 1, 0);

  const long long share = (left + options.epochs - 1) / options.epochs;
  BlockTree tree = empty_tree(statistics.n.bounds(), options.levels);
  while (left > 0) {
    update_tree(statistics, options, log.guards, tree);
    CountImage extra =
        choose_epoch(statistics, pool, std::min(share, left), left, tree.priorities, log);
    if (count_samples(extra) == 0) {  // no priority anywhere: the rest is spent uniformly
      extra = raise_least_sampled(statistics.n, pool, statistics.n.bounds(), left, context.seed);
      for (std::size_t i = 0; i < extra.size(); ++i)
        extra[i] -= statistics.n[i];
      const long long taken = count_samples(extra);
      log.uniform_remainder += taken;
      log.samples_of_level[0] += taken;
    }
    spend(spending, pool, extra);
    SPOOL_TRY(report_progress(context, "adaptive_wavelet", budget - left, budget));
  }
  return end_spending(std::move(spending), pool);
}

Sampler adaptive_wavelet_sampler() {
  return make_value<SamplerFunction, AdaptiveWaveletOptions>(
      {.name = "adaptive_wavelet",
       .summary = "dyadic blocks by the variance and energy of their Haar coefficients",
       .source = Source::kDescriptions,
       .options = adaptive_wavelet_option_table(),
       .memory = {132, 2e6},
       .cost = 5.8,
       .run = sample_adaptive_wavelet});
}

}  // namespace spool
