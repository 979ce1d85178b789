#include "lib/sampling/multiscale/priority.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "lib/core/vector_clones.h"
#include "lib/pyramid/region_mean.h"
#include "lib/pyramid/row_loop.h"
#include "lib/sampling/multiscale/region_counts.h"

namespace spool {
namespace {

// Keeps d^2 / f^2 finite in black regions; in squared units of the exposed signal (mean near 1).
constexpr double kRelativeFloor = 0.01;

constexpr double kLargestPriority = std::numeric_limits<double>::max();

// P of one row: (V + D) A. A priority that is not finite becomes the largest finite
// one; returns how many were not.
SPOOL_VECTOR_CLONES
std::int64_t absolute_row(const double* variance, const double* detail, const double* attenuation,
                          int width, double* __restrict priority) {
  std::int64_t caught = 0;
  for (int x = 0; x < width; ++x) {
    const double p = (variance[x] + detail[x] * detail[x]) * attenuation[x];
    const bool finite = p <= kLargestPriority;  // false for NaN too; none is negative
    caught += finite ? 0 : 1;
    priority[x] = finite ? p : kLargestPriority;
  }
  return caught;
}

SPOOL_VECTOR_CLONES
std::int64_t relative_row(const double* variance, const double* detail, const double* coarse,
                          const double* attenuation, int width, double* __restrict priority) {
  std::int64_t caught = 0;
  for (int x = 0; x < width; ++x) {
    const double difference = detail[x] * detail[x] / (coarse[x] * coarse[x] + kRelativeFloor);
    const double p = (variance[x] + difference) * attenuation[x];
    const bool finite = p <= kLargestPriority;
    caught += finite ? 0 : 1;
    priority[x] = finite ? p : kLargestPriority;
  }
  return caught;
}

void priority_row(const double* variance, const double* detail, const double* coarse,
                  const double* attenuation, int width, const MultiscaleOptions& options,
                  double* priority, GuardCounts& guards) {
  if (options.detail_norm == DetailNorm::kOff) {
    const std::vector<double> nothing(static_cast<std::size_t>(width));
    guards.add(Guard::kPriorityNotFinite,
               static_cast<std::uint64_t>(
                   absolute_row(variance, nothing.data(), attenuation, width, priority)));
    return;
  }
  const std::int64_t caught =
      options.detail_norm == DetailNorm::kRelative
          ? relative_row(variance, detail, coarse, attenuation, width, priority)
          : absolute_row(variance, detail, attenuation, width, priority);
  guards.add(Guard::kPriorityNotFinite, static_cast<std::uint64_t>(caught));
}

// P_k = -infinity on the part of `box` whose regions are saturated.
void close_regions(ExactBoard& board, int k, const Rectangle& box) {
  if (board.closed_pieces == 0 || box.empty()) return;
  const RegionCounts counts(board, k, box, false);
  if (counts.all_open()) return;
  Plane& priority = board.priority[static_cast<std::size_t>(k - 1)];
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x) {
      if (counts.open(x, y) == 0) priority(x, y) = -std::numeric_limits<double>::infinity();
    }
  }
}

}  // namespace

void update_variance_term(ScalarAnalysis<double>& scalar, int k, const Rectangle& box) {
  region_mean_box(scalar.contrast, k, box, scalar.variance[static_cast<std::size_t>(k - 1)]);
}

void compute_priority(ExactBoard& board, int k, const Rectangle& wanted,
                      const MultiscaleOptions& options, GuardCounts& guards) {
  const Rectangle box = intersect(wanted, board.area);
  if (box.empty()) return;
  const auto level = static_cast<std::size_t>(k);
  const auto detail = static_cast<std::size_t>(detail_of_level(k, options));
  Plane& priority = board.priority[level - 1];
  std::vector<GuardCounts> rows(static_cast<std::size_t>(box.height()));
  rows_by_area(box.y0, box.y1, box.area(), [&](int y) {
    GuardCounts& guarded = rows[static_cast<std::size_t>(y - box.y0)];
    double* row = &priority(box.x0, y);
    std::vector<double> other(board.scalars.size() > 1 ? static_cast<std::size_t>(box.width()) : 0);
    for (std::size_t i = 0; i < board.scalars.size(); ++i) {
      const ScalarAnalysis<double>& scalar = board.scalars[i];
      priority_row(&scalar.variance[level - 1](box.x0, y),
                   &scalar.pyramid.detail[detail](box.x0, y),
                   &scalar.pyramid.coarse[level](box.x0, y), &scalar.attenuation[level](box.x0, y),
                   box.width(), options, i == 0 ? row : other.data(), guarded);
      for (int x = 0; i > 0 && x < box.width(); ++x)
        row[x] = std::max(row[x], other[static_cast<std::size_t>(x)]);
    }
  });
  for (const GuardCounts& row : rows)
    guards += row;
}

void update_priority(ExactBoard& board, int k, const Rectangle& wanted,
                     const MultiscaleOptions& options, GuardCounts& guards) {
  compute_priority(board, k, wanted, options, guards);
  close_regions(board, k, intersect(wanted, board.area));
}

}  // namespace spool
