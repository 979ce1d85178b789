// Rows of the patch filter (lib/kernels/patch_tile.h): distances, boxes, weights, and their sums. A
// `width` is of whole lanes.
#pragma once

#include <cstddef>
#include <vector>

namespace spool {

inline constexpr int kPatchLanes = 16;  // rows are rounded up to as many: no loop has a rest
inline constexpr std::size_t kMostTargets = 4;
inline constexpr std::size_t kOffsetsTogether =
    3;  // offsets in turn, whose rows stay in the first cache

inline int whole_patch_lanes(int width) {
  return (width + kPatchLanes - 1) / kPatchLanes * kPatchLanes;
}

// The first of `storage` that starts a cache line, on which vectors then lie; kPatchLanes - 1 are
// to spare.
float* aligned(std::vector<float>& storage);

// A row of the guide: a pointer to each channel of the means and of kappa^2 times the variances,
// which are at most 1e10.
struct GuideRow {
  const float* a[3];
  const float* v[3];
};

// Three times d2 before its boxes, for `width` pieces p of a row; q is the piece at the offset.
void distance_row(const GuideRow& p, const GuideRow& q, float noise, int width, float* to);

// The last rows that were summed along x; a new one takes the place of the oldest.
class RowRing {
 public:
  RowRing(int rows, int width)
      : rows_(rows),
        sums_(std::size_t(rows) * std::size_t(width) + kPatchLanes),
        slots_(2 * std::size_t(rows)) {
    for (std::size_t i = 0; i < slots_.size(); ++i)
      slots_[i] = aligned(sums_) + i % std::size_t(rows) * std::size_t(width);
  }
  RowRing(RowRing&&) = default;  // a copy's slots would lie in the other one
  // The rows, oldest first; the last one is to be written.
  float* const* next() {
    newest_ = (newest_ + 1) % rows_;
    return &slots_[std::size_t(newest_ + 1)];
  }

 private:
  int rows_, newest_ = 0;
  std::vector<float> sums_;
  std::vector<float*> slots_;  // every row twice, so that any `rows` of them follow each other
};

// One more row of a box of side x side: rows[side - 1] becomes sums along `from`, and `to` scale
// times the sums of all rows, oldest first.
void box_row(const float* from, float* const* rows, int side, float scale, int width, float* to);

// row = exp(-max(0, row)).
void weights_of_distances(float* row, int width);

// What is added up at a row of pieces: of each offset a row of weights and of each target; of each
// target the pieces' own, and the sums; and the sums of the weights.
struct AddedRows {
  const float* weights[kOffsetsTogether];
  const float* from[kMostTargets][kOffsetsTogether];
  const float* own[kMostTargets];
  float* sums[kMostTargets];
  float* total;
};

// sums += weight * (from - own) and total += weight, offset by offset; weights below the least one
// count as 0, which adds nothing.
void add_targets(const AddedRows& rows, std::size_t offsets, int targets, int width);

}  // namespace spool
