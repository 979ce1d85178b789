#include "lib/sampling/multiscale/board.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/core/parallel.h"
#include "lib/sampling/multiscale/attenuation.h"
#include "lib/sampling/multiscale/priority.h"

namespace spool {
namespace {

ScalarStatistics scalar_statistics(const Samples& samples, const SamplePool& pool, std::size_t i,
                                   int left_out) {
  const CountImage& n = samples.statistics.n;
  ScalarStatistics result(n.width(), n.height());
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const int count = std::max(n(x, y) - left_out, std::min(n(x, y), 1));
      for (int s = 0; s < count; ++s)
        result.add(n.index(x, y), s + 1, samples.value(i, pool.sample(x, y, s)));
    }
  });
  return result;
}

Plane cut(const Plane& image, const Rectangle& box) {
  Plane part(box.width(), box.height());
  for (int y = 0; y < part.height(); ++y) {
    const auto row = image.row(box.y0 + y).subspan(static_cast<std::size_t>(box.x0));
    std::copy_n(row.begin(), part.width(), part.row(y).begin());
  }
  return part;
}

Board empty_board(const Rectangle& window, const Rectangle& area, std::size_t scalars,
                  const MultiscaleOptions& options) {
  Board board;
  board.window = window;
  board.area = {area.x0 - window.x0, area.y0 - window.y0, area.x1 - window.x0, area.y1 - window.y0};
  const Plane blank(window.width(), window.height());
  board.closed = Image<std::uint8_t>(window.width(), window.height());
  board.scalars.resize(scalars);
  for (ScalarAnalysis& scalar : board.scalars) {
    scalar.pyramid.coarse = {blank};
    if (options.variance_term == VarianceTerm::kRegionMinmax) {
      scalar.lowest = scalar.highest = blank;
    } else {
      scalar.contrast = blank;
    }
  }
  return board;
}

}  // namespace

Samples make_samples(PieceStatistics statistics, const SamplePool& pool, double exposure,
                     const MultiscaleOptions& options) {
  Samples samples;
  samples.statistics = std::move(statistics);
  AnalysisSignal signal;
  signal.exposure = exposure;
  signal.clamp = options.decision_clamp;
  signal.map = options.decision_map;
  if (options.channels == AnalysedChannels::kMaxRgb) signal.channel = AnalysisChannel::kMaxRgb;
  set_signal(samples.statistics, pool, signal);
  if (options.channels != AnalysedChannels::kPerChannel) {
    samples.signals = {signal};
    return samples;
  }
  // The largest of three equal channels is that channel, to the last bit.
  AnalysisSignal one_channel = signal;
  one_channel.channel = AnalysisChannel::kMaxRgb;
  samples.signals.assign(3, one_channel);
  samples.of_channel.resize(3);
  for (std::size_t c = 0; c < 3; ++c)
    samples.of_channel[c] = scalar_statistics(samples, pool, c, 0);
  return samples;
}

void take(Samples& samples, const SamplePool& pool, int x, int y, int count) {
  const std::size_t piece = samples.statistics.n.index(x, y);
  SPOOL_CHECK_LE(samples.statistics.n[piece] + count, pool.capacity(x, y));
  for (int i = 0; i < count; ++i)
    add_sample(samples, piece, pool.sample(x, y, samples.statistics.n[piece]));
}

void add_sample(Samples& samples, std::size_t piece, const Rgb& radiance) {
  add_sample(samples.statistics, piece, radiance);
  for (std::size_t c = 0; c < samples.of_channel.size(); ++c)
    samples.of_channel[c].add(piece, samples.statistics.n[piece], samples.value(c, radiance));
}

Plane means_before_last(const Samples& samples, const SamplePool& pool, std::size_t i) {
  return scalar_statistics(samples, pool, i, 1).mean;
}

PyramidOptions board_pyramid(const MultiscaleOptions& options) {
  PyramidOptions pyramid = options.pyramid;
  if (options.detail_index == DetailIndex::kSameK) ++pyramid.levels;
  return pyramid;
}

void load_piece(Board& board, const Samples& samples, int x, int y,
                const MultiscaleOptions& options, GuardCounts& guards) {
  const PieceStatistics& statistics = samples.statistics;
  const std::size_t piece = statistics.n.index(x + board.window.x0, y + board.window.y0);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    const ScalarStatistics& from = samples.scalar(i);
    scalar.pyramid.coarse[0](x, y) = from.mean[piece];
    if (options.variance_term == VarianceTerm::kRegionMinmax) {
      scalar.lowest(x, y) = from.minimum[piece];
      scalar.highest(x, y) = from.maximum[piece];
    } else {
      scalar.contrast(x, y) = statistics.n[piece] < 2
                                  ? 0.0
                                  : squared_contrast(from.minimum[piece], from.maximum[piece],
                                                     options.contrast, guards);
    }
  }
}

Board load_board(const Samples& samples, const SamplePool& pool, const Rectangle& window,
                 const Rectangle& area, const MultiscaleOptions& options, GuardCounts& guards) {
  Board board = empty_board(window, area, samples.scalars(), options);
  std::vector<GuardCounts> rows(static_cast<std::size_t>(window.height()));
  parallel_rows(0, window.height(), [&](int y) {
    for (int x = 0; x < window.width(); ++x)
      load_piece(board, samples, x, y, options, rows[static_cast<std::size_t>(y)]);
  });
  for (const GuardCounts& row : rows)
    guards += row;
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x) {
      const int gx = x + window.x0, gy = y + window.y0;
      if (samples.statistics.n(gx, gy) < pool.capacity(gx, gy)) continue;
      board.closed(x, y) = 1;
      ++board.closed_pieces;
    }
  }
  return board;
}

Board cut_board(const Board& whole, const Rectangle& window, const Rectangle& area,
                const MultiscaleOptions& options) {
  Board board = empty_board(window, area, whole.scalars.size(), options);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    const ScalarAnalysis& from = whole.scalars[i];
    scalar.pyramid.coarse[0] = cut(from.pyramid.coarse[0], window);
    if (!from.contrast.empty()) scalar.contrast = cut(from.contrast, window);
    if (!from.lowest.empty()) scalar.lowest = cut(from.lowest, window);
    if (!from.highest.empty()) scalar.highest = cut(from.highest, window);
  }
  for (int y = board.area.y0; y < board.area.y1; ++y) {
    for (int x = board.area.x0; x < board.area.x1; ++x) {
      board.closed(x, y) = whole.closed(x + window.x0, y + window.y0);
      board.closed_pieces += board.closed(x, y);
    }
  }
  return board;
}

void analyse(Board& board, const std::vector<Plane>& before_last, const MultiscaleOptions& options,
             GuardCounts& guards) {
  const auto levels = static_cast<std::size_t>(options.levels());
  const int width = board.window.width(), height = board.window.height();
  board.fresh = CountImage(width, height);
  for (std::size_t i = 0; i < board.scalars.size(); ++i) {
    ScalarAnalysis& scalar = board.scalars[i];
    rebuild_pyramid(scalar.pyramid, scalar.pyramid.coarse[0], board_pyramid(options));  // eqs 1-4
    start_attenuation(scalar, board.window, before_last.empty() ? nullptr : &before_last[i],
                      options);
    scalar.variance.assign(levels, Plane(width, height));
    for (int k = 1; k <= options.levels(); ++k)
      update_variance_term(scalar, k, board.bounds(), options, guards);  // eq 6
  }
  board.priority.assign(levels, Plane(width, height, -std::numeric_limits<double>::infinity()));
  for (int k = 1; k <= options.levels(); ++k)
    update_priority(board, k, board.area, options, guards);  // eq 5
}

void forget_analysis(Board& board) {
  for (ScalarAnalysis& scalar : board.scalars) {
    scalar.pyramid.coarse.resize(1);
    scalar.pyramid.detail.clear();
    scalar.variance.clear();
    scalar.attenuation.clear();
  }
  board.priority.clear();
  board.fresh = CountImage();
}

Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options) {
  // The reach is that of one changed piece far from every border, mirrored: what a value reads.
  constexpr int kFar = 1 << 14;
  std::vector<Rectangle> coarse, detail;
  pyramid_influence({kFar, kFar, kFar + 1, kFar + 1}, {0, 0, 2 * kFar, 2 * kFar},
                    board_pyramid(options), coarse, detail);
  int reach = 1 << (options.levels() - 1);
  for (const auto* boxes : {&coarse, &detail}) {
    for (const Rectangle& box : *boxes)
      reach = std::max({reach, kFar - box.x0, box.x1 - 1 - kFar});
  }
  Rectangle window = grow(area, reach, reach, reach, reach, bounds);
  const int lattice = 1 << (options.levels() + 1);  // phase00 counts phases from the corner
  window.x0 -= window.x0 % lattice;
  window.y0 -= window.y0 % lattice;
  return window;
}

}  // namespace spool
