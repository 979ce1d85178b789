#include "lib/filters/directional/stop_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
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

// Adds the largest (q_{k+1} - q_k)^2 - bound Var over the regions that touch the piece.
void add_evidence(const SizeStep& step, double bound, Plane& beyond) {
  const int width = step.fine.width(), height = step.fine.height();
  if (beyond.empty()) beyond = Plane(width, height);
  const int shifts = step.regions ? 2 : 1;
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const double own = step.own_share * step.fine_noise(x, y);
      double most = -std::numeric_limits<double>::infinity();
      for (int qy = y; qy < std::min(y + shifts, height); ++qy) {
        for (int qx = x; qx < std::min(x + shifts, width); ++qx) {
          const double dq = step.coarse(qx, qy) - step.fine(x, y);
          most = std::max(most, dq * dq - bound * (step.coarse_noise(qx, qy) + own));
        }
      }
      beyond(x, y) += most;
    }
  });
}

}  // namespace

Plane cautious_variance(const Plane& variance) {
  const int width = variance.width(), height = variance.height();
  Plane cautious(width, height);
  parallel_rows(0, height, [&](int y) {
    std::array<double, 9> around;
    for (int x = 0; x < width; ++x) {
      for (int i = 0; i < 9; ++i) {
        around[static_cast<std::size_t>(i)] = variance(extend_symmetric(x + i % 3 - 1, width),
                                                       extend_symmetric(y + i / 3 - 1, height));
      }
      std::nth_element(around.begin(), around.begin() + 4, around.end());
      cautious(x, y) = std::max(variance(x, y), around[4]);
    }
  });
  return cautious;
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
