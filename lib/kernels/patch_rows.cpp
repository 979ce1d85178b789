#include "lib/kernels/patch_rows.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "lib/core/eight_floats.h"
#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr float kEpsilon = 1e-10f;
constexpr float kLeastWeight = 0.05f;
constexpr int kUsualSide = 7;  // of a patch

// Of numbers that are not negative, by the order of their bits: a comparison of floats may trap,
// which leaves AVX2 without vectors.
float smaller(float a, float b) {
  return std::bit_cast<float>(
      std::min(std::bit_cast<std::int32_t>(a), std::bit_cast<std::int32_t>(b)));
}

SPOOL_VECTOR_CLONES
void box_row_of_any_side(const float* from, float* const* rows, int side, float scale, int width,
                         float* __restrict to) {
  float* __restrict along = rows[side - 1];
  std::copy_n(from, width, along);
  for (int i = 1; i < side; ++i) {
    for (int x = 0; x < width; ++x)
      along[x] += from[x + i];
  }
  std::copy_n(rows[0], width, to);
  for (int j = 1; j < side; ++j) {
    const float* row = rows[j];
    for (int x = 0; x < width; ++x)
      to[x] += row[x];
  }
  for (int x = 0; x < width; ++x)
    to[x] *= scale;
}

// Sums stay in registers.
SPOOL_VECTOR_CLONES
void box_row_of_usual_side(const float* from, float* const* rows, float scale, int width,
                           float* __restrict to) {
  static_assert(kUsualSide == 7);
  const float *r0 = rows[0], *r1 = rows[1], *r2 = rows[2], *r3 = rows[3], *r4 = rows[4],
              *r5 = rows[5];
  float* __restrict along = rows[6];
  for (int x = 0; x < width; ++x) {
    const float sum =
        from[x] + from[x + 1] + from[x + 2] + from[x + 3] + from[x + 4] + from[x + 5] + from[x + 6];
    along[x] = sum;
    to[x] = (r0[x] + r1[x] + r2[x] + r3[x] + r4[x] + r5[x] + sum) * scale;
  }
}

template <class Vector, int kOffsets>
[[gnu::always_inline]] inline void add_rows(const AddedRows& rows, int targets, int width) {
  for (int x = 0; x < width; x += kFloats<Vector>) {
    Vector weight[kOffsets], sum, own, from;
    std::memcpy(&sum, rows.total + x, sizeof(Vector));
#pragma GCC unroll 3
    for (int i = 0; i < kOffsets; ++i) {
      std::memcpy(&weight[i], rows.weights[i] + x, sizeof(Vector));
      weight[i] = weight[i] < kLeastWeight ? Vector{} : weight[i];
      sum += weight[i];
    }
    std::memcpy(rows.total + x, &sum, sizeof(Vector));
    for (int t = 0; t < targets; ++t) {
      std::memcpy(&sum, rows.sums[t] + x, sizeof(Vector));
      std::memcpy(&own, rows.own[t] + x, sizeof(Vector));
#pragma GCC unroll 3
      for (int i = 0; i < kOffsets; ++i) {
        std::memcpy(&from, rows.from[t][i] + x, sizeof(Vector));
        sum += weight[i] * (from - own);
      }
      std::memcpy(rows.sums[t] + x, &sum, sizeof(Vector));
    }
  }
}

template <class Vector>
[[gnu::always_inline]] inline void add_offsets(const AddedRows& rows, std::size_t offsets,
                                               int targets, int width) {
  static_assert(kOffsetsTogether == 3);
  if (offsets == 1) return add_rows<Vector, 1>(rows, targets, width);
  if (offsets == 2) return add_rows<Vector, 2>(rows, targets, width);
  add_rows<Vector, 3>(rows, targets, width);
}

SPOOL_VECTOR_WIDTHS(void add_by_width(const AddedRows& rows, std::size_t offsets, int targets,
                                      int width),
                    add_offsets<Vector>(rows, offsets, targets, width))

}  // namespace

float* aligned(std::vector<float>& storage) {
  const auto address = reinterpret_cast<std::uintptr_t>(storage.data()) / sizeof(float);
  return storage.data() + (kPatchLanes - address % kPatchLanes) % kPatchLanes;
}

// The channels are brought to one denominator: a division costs as much as all the rest. Variances
// are at most kMostVariance, so that three of them times each other stay in float.
SPOOL_VECTOR_CLONES
void distance_row(const GuideRow& p, const GuideRow& q, float noise, int width,
                  float* __restrict to) {
  const float *a0 = p.a[0], *a1 = p.a[1], *a2 = p.a[2];
  const float *b0 = q.a[0], *b1 = q.a[1], *b2 = q.a[2];
  const float *v0 = p.v[0], *v1 = p.v[1], *v2 = p.v[2];
  const float *u0 = q.v[0], *u1 = q.v[1], *u2 = q.v[2];
  // v_p and the smaller variance together are the smaller of two sums, to the last bit.
  const auto numerator = [=](float ap, float aq, float vp, float both) {
    const float difference = ap - aq;
    return difference * difference - noise * smaller(vp + vp, both);
  };
  for (int x = 0; x < width; ++x) {
    const float s0 = v0[x] + u0[x], s1 = v1[x] + u1[x], s2 = v2[x] + u2[x];
    const float d0 = kEpsilon + s0, d1 = kEpsilon + s1, d2 = kEpsilon + s2;
    const float n0 = numerator(a0[x], b0[x], v0[x], s0), n1 = numerator(a1[x], b1[x], v1[x], s1),
                n2 = numerator(a2[x], b2[x], v2[x], s2);
    const float d01 = d0 * d1;
    to[x] = ((n0 * d1 + n1 * d0) * d2 + n2 * d01) / (d01 * d2);
  }
}

SPOOL_VECTOR_CLONES
void weights_of_distances(float* __restrict row, int width) {
  for (int x = 0; x < width; ++x) {
    const auto distance = std::max(std::bit_cast<std::int32_t>(row[x]), 0);  // negative floats, too
    row[x] = exp_negative(std::bit_cast<float>(distance));
  }
}

void box_row(const float* from, float* const* rows, int side, float scale, int width, float* to) {
  if (side == kUsualSide) {
    box_row_of_usual_side(from, rows, scale, width, to);
  } else {
    box_row_of_any_side(from, rows, side, scale, width, to);
  }
}

void add_targets(const AddedRows& rows, std::size_t offsets, int targets, int width) {
  add_by_width(rows, offsets, targets, width);
}

}  // namespace spool
