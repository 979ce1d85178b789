#include "lib/filters/directional/stop_votes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kOwnVote = 0.01;     // weight that a piece keeps in its neighbours' vote
constexpr double kHalf = 0.5 - 1e-9;  // a tie at a straight border must not hang on rounding

// The decision of every piece after its neighbours have voted.
Plane after_vote(const Plane& stop, int k, SizeSmooth rule) {
  if (rule == SizeSmooth::kOff) return stop;
  const double sigma = std::max(0.8, 0.7 * std::ldexp(1.0, k));
  const Taps taps = gaussian_taps(sigma);
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  const double own = std::max(0.0, middle * middle - kOwnVote);
  Plane decided = convolve(stop, taps);
  parallel_rows(0, stop.height(), [&](int y) {
    for (int x = 0; x < stop.width(); ++x) {
      if (rule == SizeSmooth::kOn) {
        decided(x, y) = decided(x, y) >= kHalf ? 1.0 : 0.0;
      } else {
        const double others = (decided(x, y) - own * stop(x, y)) / (1.0 - own);
        decided(x, y) = stop(x, y) > 0.0 && others >= kHalf ? 1.0 : 0.0;
      }
    }
  });
  return decided;
}

// most[x] becomes at least (q_{k+1} - q_k)^2 - bound Var of a row against the pieces of another.
SPOOL_VECTOR_CLONES
void raise_to_evidence(const double* fine, const double* fine_noise, const double* coarse,
                       const double* coarse_noise, double own_share, double bound, int width,
                       double* __restrict most) {
  for (int x = 0; x < width; ++x) {
    const double dq = coarse[x] - fine[x];
    most[x] = std::max(most[x], dq * dq - bound * (coarse_noise[x] + own_share * fine_noise[x]));
  }
}

// The three values above each other in each column of a row's neighbourhood, sorted; column x lies
// at x + 1, the borders are mirrored.
struct SortedColumns {
  explicit SortedColumns(int width)
      : low(static_cast<std::size_t>(width) + 2), middle(low.size()), high(low.size()) {}
  std::vector<double> low, middle, high;
};

SPOOL_VECTOR_CLONES
void sort_three(const double* a, const double* b, const double* c, int width,
                double* __restrict low, double* __restrict middle, double* __restrict high) {
  for (int x = 0; x < width; ++x) {
    const double less = std::min(a[x], b[x]), more = std::max(a[x], b[x]);
    const double upper = std::max(less, c[x]);
    low[x] = std::min(less, c[x]);
    middle[x] = std::min(more, upper);
    high[x] = std::max(more, upper);
  }
}

void sort_columns(const double* above, const double* own, const double* below, int width,
                  SortedColumns& columns) {
  sort_three(above, own, below, width, &columns.low[1], &columns.middle[1], &columns.high[1]);
  for (std::vector<double>* line : {&columns.low, &columns.middle, &columns.high}) {
    line->front() = (*line)[1];
    line->back() = (*line)[line->size() - 2];
  }
}

inline double median_of_three(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

// The median of nine values is the median of three of their columns' sorted ones: the largest of
// the low, the median of the middle and the smallest of the high.
SPOOL_VECTOR_CLONES
void larger_of_own_and_median(const double* own, const double* low, const double* middle,
                              const double* high, int width, double* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const double median = median_of_three(std::max(std::max(low[x], low[x + 1]), low[x + 2]),
                                          median_of_three(middle[x], middle[x + 1], middle[x + 2]),
                                          std::min(std::min(high[x], high[x + 1]), high[x + 2]));
    to[x] = std::max(own[x], median);
  }
}

}  // namespace

Plane cautious_variance(const Plane& variance) {
  const int width = variance.width(), height = variance.height();
  Plane cautious(width, height);
  parallel_rows(0, height, [&](int y) {
    SortedColumns columns(width);
    sort_columns(variance.row(extend_symmetric(y - 1, height)).data(), variance.row(y).data(),
                 variance.row(extend_symmetric(y + 1, height)).data(), width, columns);
    larger_of_own_and_median(variance.row(y).data(), columns.low.data(), columns.middle.data(),
                             columns.high.data(), width, cautious.row(y).data());
  });
  return cautious;
}

void add_evidence(const SizeStep& step, double bound, Plane& beyond) {
  const int width = step.fine.width(), height = step.fine.height();
  if (beyond.empty()) beyond = Plane(width, height);
  const int shifts = step.regions ? 2 : 1;
  parallel_rows(0, height, [&](int y) {
    std::vector<double> most(static_cast<std::size_t>(width),
                             -std::numeric_limits<double>::infinity());
    for (int dy = 0; dy < std::min(shifts, height - y); ++dy) {
      for (int dx = 0; dx < std::min(shifts, width); ++dx) {
        raise_to_evidence(step.fine.row(y).data(), step.fine_noise.row(y).data(),
                          step.coarse.row(y + dy).data() + dx,
                          step.coarse_noise.row(y + dy).data() + dx, step.own_share, bound,
                          width - dx, most.data());
      }
    }
    for (int x = 0; x < width; ++x)
      beyond(x, y) += most[static_cast<std::size_t>(x)];
  });
}

void add_step(const SizeStep& step, const Plane& w, std::size_t signals, double evidence,
              SizeCriterion& criterion) {
  const double share = 1.0 / static_cast<double>(signals);
  Plane& t = criterion.t;
  if (t.empty()) t = Plane(w.width(), w.height());
  parallel_rows(0, w.height(), [&](int y) {
    for (std::size_t i = w.index(0, y); i < w.index(0, y + 1); ++i) {
      const double dq = step.coarse[i] - step.fine[i];
      t[i] += share * (step.coarse_variance[i] - step.fine_variance[i] + w[i] * dq * dq);
    }
  });
  if (evidence > 0.0) add_evidence(step, evidence * evidence, criterion.beyond);
}

Plane decide_stops(const SizeCriterion& criterion, int k, SizeSmooth rule, GuardCounts& guards) {
  const Plane& t = criterion.t;
  Plane stop(t.width(), t.height());
  std::vector<GuardCounts> rows(static_cast<std::size_t>(t.height()));
  parallel_rows(0, t.height(), [&](int y) {
    for (int x = 0; x < t.width(); ++x) {
      const bool finite = std::isfinite(t(x, y));
      if (!finite) rows[static_cast<std::size_t>(y)].add(Guard::kSizeNotFinite);
      stop(x, y) = !finite || t(x, y) > 0.0 ? 1.0 : 0.0;
    }
  });
  for (const GuardCounts& row : rows)
    guards += row;
  Plane decided = after_vote(stop, k, rule);
  for (std::size_t i = 0; i < criterion.beyond.size(); ++i) {
    if (criterion.beyond[i] > 0.0) decided[i] = 1.0;
  }
  return decided;
}

}  // namespace spool
