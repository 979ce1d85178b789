#include "lib/sampling/multiscale/block_analysis.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "lib/core/parallel_count.h"
#include "lib/core/vector_clones.h"
#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kRelativeFloor = 0.01f;  // of d_norm = relative (priority.cpp)

int reach_of(const Taps& taps, int k) {
  return std::max(taps.last(), -taps.first) * pyramid_dilation(k);
}

// Columns (or rows) of the regions R_level at begin .. end - 1 that lie in [low, high).
std::vector<std::int32_t> clipped_sides(int level, int begin, int end, int low, int high) {
  const int before = 1 << (level - 1), after = before - 1;
  std::vector<std::int32_t> sides;
  for (int i = begin; i < end; ++i)
    sides.push_back(std::min(i + after + 1, high) - std::max(i - before, low));
  return sides;
}

SPOOL_VECTOR_CLONES
void scale_row(float factor, const float* columns, int width, float* __restrict row) {
  for (int x = 0; x < width; ++x)
    row[x] *= factor * columns[x];
}

// (V + D) A with D = d^2 [LiuZheng (5)]. A priority that is not finite becomes the largest finite
// one; returns how many were not.
SPOOL_VECTOR_CLONES
std::int32_t absolute_row(const float* variance, const float* fine, const float* prediction,
                          const float* attenuation, int width, float* __restrict priority) {
  std::int32_t caught = 0;
  for (int x = 0; x < width; ++x) {
    const float detail = fine[x] - prediction[x];
    const float p = (variance[x] + detail * detail) * attenuation[x];
    const bool finite = p <= kLargest;  // false for NaN too; none is negative
    caught += finite ? 0 : 1;
    priority[x] = finite ? p : kLargest;
  }
  return caught;
}

// The same with D = d^2 / (f_k^2 + floor).
SPOOL_VECTOR_CLONES
std::int32_t relative_row(const float* variance, const float* fine, const float* prediction,
                          const float* coarse, const float* attenuation, int width,
                          float* __restrict priority) {
  std::int32_t caught = 0;
  for (int x = 0; x < width; ++x) {
    const float detail = fine[x] - prediction[x];
    const float relative = detail * detail / (coarse[x] * coarse[x] + kRelativeFloor);
    const float p = (variance[x] + relative) * attenuation[x];
    const bool finite = p <= kLargest;
    caught += finite ? 0 : 1;
    priority[x] = finite ? p : kLargest;
  }
  return caught;
}

// Entries with floor(x / D) and floor(y / D) even, 0 elsewhere: phase (0, 0).
void keep_phase00(Patch<float>& patch, const Rectangle& bounds, int dilation) {
  const Rectangle inside = intersect(patch.extent(), bounds);
  for (int y = inside.y0; y < inside.y1; ++y) {
    for (int x = inside.x0; x < inside.x1; ++x) {
      if (x / dilation % 2 != 0 || y / dilation % 2 != 0) *patch.at(x, y) = 0.0f;
    }
  }
}

template <class T>
bool all_zero(const Patch<T>& patch) {
  const T* values = patch.at(patch.extent().x0, patch.extent().y0);
  return std::all_of(values, values + patch.extent().area(), [](T v) { return v == T{}; });
}

// Sums over R_1 .. R_K of the entries of a box, from pieces in and around it.
template <class T>
std::vector<Patch<T>> region_sums(const Patch<T>& pieces, int levels) {
  std::vector<Patch<T>> sums;
  for (int k = 1; k <= levels; ++k)
    sums.push_back(double_up(k == 1 ? pieces : sums.back(), k));
  return sums;
}

// Copies what a patch has of a box into an image; an image that is not kept is empty.
void keep(const Patch<float>& patch, const Rectangle& box, Image<float>& image) {
  if (image.empty()) return;
  for (int y = box.y0; y < box.y1; ++y)
    std::copy_n(patch.at(box.x0, y), box.width(), &image(box.x0, y));
}

// d = f - what predicts it [LiuZheng (4)]
void keep_detail(const Patch<float>& fine, const Patch<float>& prediction, const Rectangle& box,
                 Image<float>& detail) {
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x)
      detail(x, y) = *fine.at(x, y) - *prediction.at(x, y);
  }
}

}  // namespace

BlockAnalysis::BlockAnalysis(EpochBoard& board, const MultiscaleOptions& options)
    : board_(board), options_(options), pyramid_(board_pyramid(options)) {
  for (int k = 0; k <= options.levels(); ++k)
    weights_.emplace_back(k, options);
  const int levels = pyramid_.levels;
  margin_.assign(static_cast<std::size_t>(levels) + 1, 0);
  for (int k = levels; k >= 0; --k) {
    int& margin = margin_[static_cast<std::size_t>(k)];
    if (k < levels) {
      margin = margin_[static_cast<std::size_t>(k) + 1] + reach_of(analysis_taps(pyramid_, k), k);
    }
    if (k > 0) margin = std::max(margin, reach_of(prediction_taps(pyramid_, k - 1), k - 1));
  }
  reach_ = std::max(margin_[0], region_reach());
}

// What eq 4 takes off f_k.
Patch<float> BlockAnalysis::predict(const Patch<float>& coarse, int k, const Rectangle& box) const {
  const Taps taps = prediction_taps(pyramid_, k);
  Patch<float> prediction(box);
  if (pyramid_.detail == LaplacianDetail::kCycleSpun) {
    convolve_patch(coarse, taps, pyramid_dilation(k), box, prediction);
    return prediction;
  }
  Patch<float> masked(coarse.extent());
  std::copy_n(coarse.at(coarse.extent().x0, coarse.extent().y0), coarse.extent().area(),
              masked.at(coarse.extent().x0, coarse.extent().y0));
  keep_phase00(masked, board_.bounds(), pyramid_dilation(k));
  extend_patch(masked, board_.bounds(), pyramid_.extension);
  convolve_patch(masked, taps, pyramid_dilation(k), box, prediction);
  return prediction;
}

// V_1 .. V_K of the box [LiuZheng (6)].
std::vector<Patch<float>> BlockAnalysis::variances(const ScalarAnalysis<float>& scalar,
                                                   const Rectangle& box) const {
  const Rectangle bounds = board_.bounds();
  std::vector<Patch<float>> means =
      region_sums(padded_patch<float, float>(scalar.contrast, bounds, grown(box, region_reach())),
                  options_.levels());
  for (int k = 1; k <= options_.levels(); ++k) {
    std::vector<float> columns;
    for (const std::int32_t side : clipped_sides(k, box.x0, box.x1, bounds.x0, bounds.x1))
      columns.push_back(1.0f / static_cast<float>(side));
    const auto rows = clipped_sides(k, box.y0, box.y1, bounds.y0, bounds.y1);
    for (int y = box.y0; y < box.y1; ++y) {
      scale_row(1.0f / static_cast<float>(rows[static_cast<std::size_t>(y - box.y0)]),
                columns.data(), box.width(), means[static_cast<std::size_t>(k - 1)].at(box.x0, y));
    }
  }
  return means;
}

// A_k of the box from f_k after and before the step [LiuZheng (7), (8)].
void BlockAnalysis::attenuate(ScalarAnalysis<float>& scalar, int k, const Rectangle& box,
                              const Counts& counts, const Patch<float>& now) const {
  const auto level = static_cast<std::size_t>(k);
  const Rectangle& area = board_.area;
  const auto columns = clipped_sides(k, box.x0, box.x1, area.x0, area.x1);
  const auto rows = clipped_sides(k, box.y0, box.y1, area.y0, area.y1);
  for (int y = box.y0; y < box.y1; ++y) {
    const RegionRow regions = {
        counts.fresh[level - 1].at(box.x0, y),
        counts.closed.empty() ? nullptr : counts.closed[level - 1].at(box.x0, y), columns.data(),
        rows[static_cast<std::size_t>(y - box.y0)]};
    weights_[level].update_row(regions, now.at(box.x0, y), &scalar.pyramid.coarse[level](box.x0, y),
                               box.width(), &scalar.attenuation[level](box.x0, y));
  }
}

// P_k of the box [LiuZheng (5)]; of several scalars the largest.
void BlockAnalysis::prioritise(const ScalarAnalysis<float>& scalar, int k, const Rectangle& box,
                               const Patch<float>& variance, const Patch<float>& fine,
                               const Patch<float>& prediction, GuardCounts& guards) const {
  const auto level = static_cast<std::size_t>(k);
  std::vector<float> row(static_cast<std::size_t>(box.width()));
  std::int64_t caught = 0;
  for (int y = box.y0; y < box.y1; ++y) {
    float* to = &board_.priority[level - 1](box.x0, y);
    const float *v = variance.at(box.x0, y), *a = &scalar.attenuation[level](box.x0, y);
    const float *f = fine.at(box.x0, y), *p = prediction.at(box.x0, y);
    const bool first = &scalar == &board_.scalars.front();
    float* now = first ? to : row.data();
    if (options_.detail_norm == DetailNorm::kRelative) {
      caught +=
          relative_row(v, f, p, &scalar.pyramid.coarse[level](box.x0, y), a, box.width(), now);
    } else {
      if (options_.detail_norm == DetailNorm::kOff) p = f;
      caught += absolute_row(v, f, p, a, box.width(), now);
    }
    for (int x = 0; !first && x < box.width(); ++x)
      to[x] = std::max(to[x], row[static_cast<std::size_t>(x)]);
  }
  guards.add(Guard::kPriorityNotFinite, static_cast<std::uint64_t>(caught));
}

BlockAnalysis::Counts BlockAnalysis::counts_of(const Rectangle& box) const {
  const Rectangle around = grown(box, region_reach());
  Counts counts;
  const auto fresh = padded_patch<std::uint8_t, std::int32_t>(board_.fresh, board_.area, around);
  if (options_.attenuation == AttenuationUpdate::kAnyTouch || !all_zero(fresh))
    counts.fresh = region_sums(fresh, options_.levels());
  if (counts.fresh.empty() || board_.closed_pieces == 0) return counts;
  const auto closed = padded_patch<std::uint8_t, std::int32_t>(board_.closed, board_.area, around);
  if (!all_zero(closed)) counts.closed = region_sums(closed, options_.levels());
  return counts;
}

void BlockAnalysis::update(const Rectangle& box, GuardCounts& guards) const {
  const Counts counts = counts_of(box);
  for (ScalarAnalysis<float>& scalar : board_.scalars) {
    PyramidImages<float>& images = scalar.pyramid;
    const std::vector<Patch<float>> variance = variances(scalar, box);
    for (std::size_t k = 0; k < scalar.variance.size(); ++k)
      keep(variance[k], box, scalar.variance[k]);
    Patch<float> fine =
        extended_patch(images.coarse[0], pyramid_.extension, grown(box, margin_[0]));
    for (int k = 0; k < pyramid_.levels; ++k) {
      const auto level = static_cast<std::size_t>(k);
      // f_(k+1) [LiuZheng (1)-(3)]; its border follows from what is inside.
      Patch<float> coarse(grown(box, margin_[level + 1]));
      convolve_patch(fine, analysis_taps(pyramid_, k), pyramid_dilation(k),
                     intersect(coarse.extent(), board_.bounds()), coarse);
      extend_patch(coarse, board_.bounds(), pyramid_.extension);
      if (k < options_.levels() && !counts.fresh.empty())
        attenuate(scalar, k + 1, box, counts, coarse);
      keep(coarse, box, images.coarse[level + 1]);
      const Patch<float> prediction = predict(coarse, k, box);
      if (!images.detail.empty()) keep_detail(fine, prediction, box, images.detail[level]);
      const int looks = options_.detail_index == DetailIndex::kProducedWithLevel ? k + 1 : k;
      if (looks >= 1 && looks <= options_.levels()) {
        prioritise(scalar, looks, box, variance[static_cast<std::size_t>(looks - 1)], fine,
                   prediction, guards);
      }
      fine = std::move(coarse);
    }
  }
}

void BlockAnalysis::update_pieces(std::span<const Pick> picks,
                                  const std::vector<std::vector<float>>& before) const {
  constexpr std::int32_t kOne = 1;
  constexpr std::size_t kChunk = 4096;
  const auto update = [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = 0; s < board_.scalars.size(); ++s) {
      ScalarAnalysis<float>& scalar = board_.scalars[s];
      for (std::size_t i = begin; i < end; ++i) {
        const Pick& pick = picks[i];
        const std::int32_t closed = board_.closed(pick.x, pick.y);
        weights_[0].update_row({&pick.count, &closed, &kOne, 1},
                               &scalar.pyramid.coarse[0](pick.x, pick.y), &before[s][i], 1,
                               &scalar.attenuation[0](pick.x, pick.y));
      }
    }
  };
  parallel_stretches(picks.size(), update, kChunk);
}

void BlockAnalysis::close(const Rectangle& box) const {
  if (board_.closed_pieces == 0) return;
  const Rectangle& area = board_.area;
  const auto pieces =
      padded_patch<std::uint8_t, std::int32_t>(board_.closed, area, grown(box, region_reach()));
  if (all_zero(pieces)) return;
  const std::vector<Patch<std::int32_t>> closed = region_sums(pieces, options_.levels());
  for (int k = 1; k <= options_.levels(); ++k) {
    const auto level = static_cast<std::size_t>(k - 1);
    const auto columns = clipped_sides(k, box.x0, box.x1, area.x0, area.x1);
    const auto rows = clipped_sides(k, box.y0, box.y1, area.y0, area.y1);
    for (int y = box.y0; y < box.y1; ++y) {
      const std::int32_t* of_row = closed[level].at(box.x0, y);
      float* priority = &board_.priority[level](box.x0, y);
      const std::int32_t height = rows[static_cast<std::size_t>(y - box.y0)];
      for (int x = 0; x < box.width(); ++x) {
        if (of_row[x] == columns[static_cast<std::size_t>(x)] * height)
          priority[x] = -std::numeric_limits<float>::infinity();
      }
    }
  }
}

}  // namespace spool
