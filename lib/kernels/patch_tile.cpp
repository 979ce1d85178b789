#include "lib/kernels/patch_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "lib/core/exponential.h"
#include "lib/core/extend.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr float kEpsilon = 1e-10f;
constexpr float kLeastWeight = 0.05f;
constexpr double kMostMean = 1e15, kMostVariance = 1e10;  // the latter times kappa^2
constexpr std::size_t kMostTargets = 4;
constexpr int kUsualSide = 7;  // of a patch
constexpr int kLanes = 16;     // rows are rounded up to as many, so that no loop has a rest

int whole_lanes(int width) {
  return (width + kLanes - 1) / kLanes * kLanes;
}

// A row of the guide: a pointer to each channel of the means and of kappa^2 times the variances.
struct GuideRow {
  const float* a[3];
  const float* v[3];
};

// Three times d2 before its boxes, for `width` pieces p of a row; q is the piece at the offset. The
// channels are brought to one denominator: a division costs as much as all the rest. Variances are
// at most kMostVariance, so that three of them times each other stay in float.
SPOOL_VECTOR_CLONES
void distance_row(const GuideRow& p, const GuideRow& q, float noise, int width,
                  float* __restrict to) {
  const float *a0 = p.a[0], *a1 = p.a[1], *a2 = p.a[2];
  const float *b0 = q.a[0], *b1 = q.a[1], *b2 = q.a[2];
  const float *v0 = p.v[0], *v1 = p.v[1], *v2 = p.v[2];
  const float *u0 = q.v[0], *u1 = q.v[1], *u2 = q.v[2];
  const auto numerator = [=](float ap, float aq, float vp, float vq) {
    const float difference = ap - aq;
    // Variances are not negative, and so have the order of their bits; a comparison of floats may
    // trap, which leaves AVX2 without vectors.
    const auto least = std::min(std::bit_cast<std::int32_t>(vp), std::bit_cast<std::int32_t>(vq));
    return difference * difference - noise * (vp + std::bit_cast<float>(least));
  };
  for (int x = 0; x < width; ++x) {
    const float d0 = kEpsilon + (v0[x] + u0[x]), d1 = kEpsilon + (v1[x] + u1[x]),
                d2 = kEpsilon + (v2[x] + u2[x]);
    const float n0 = numerator(a0[x], b0[x], v0[x], u0[x]),
                n1 = numerator(a1[x], b1[x], v1[x], u1[x]),
                n2 = numerator(a2[x], b2[x], v2[x], u2[x]);
    const float d01 = d0 * d1;
    to[x] = ((n0 * d1 + n1 * d0) * d2 + n2 * d01) / (d01 * d2);
  }
}

// The first of `storage` that starts a cache line, on which vectors then lie; kLanes - 1 are to
// spare.
float* aligned(std::vector<float>& storage) {
  const auto address = reinterpret_cast<std::uintptr_t>(storage.data()) / sizeof(float);
  return storage.data() + (kLanes - address % kLanes) % kLanes;
}

// The last rows that were summed along x; a new one takes the place of the oldest.
class RowRing {
 public:
  RowRing(int rows, int width)
      : rows_(rows),
        sums_(std::size_t(rows) * std::size_t(width) + kLanes),
        slots_(2 * std::size_t(rows)) {
    for (std::size_t i = 0; i < slots_.size(); ++i)
      slots_[i] = aligned(sums_) + i % std::size_t(rows) * std::size_t(width);
  }
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

// The same of the usual side: sums stay in registers.
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

SPOOL_VECTOR_CLONES
void weights_of_distances(float* __restrict row, int width) {
  for (int x = 0; x < width; ++x)
    row[x] = row[x] > 0.0f ? row[x] : 0.0f;
  for (int x = 0; x < width; ++x)  // apart: folded into one loop it has no vectors for AVX2
    row[x] = exp_negative(row[x]);
}

// sums[i] += weight * (from[i] - own[i]) and total += weight; weights below the least one count as
// 0, which adds nothing.
template <int kTargets>
SPOOL_VECTOR_CLONES void add_targets(const float* __restrict weight, int width,
                                     float* __restrict total, const float* const* from,
                                     const float* const* own, float* const* sums) {
  static_assert(kTargets >= 1 && kTargets <= 4);
  constexpr int k1 = kTargets > 1 ? 1 : 0, k2 = kTargets > 2 ? 2 : 0, k3 = kTargets > 3 ? 3 : 0;
  const float *f0 = from[0], *f1 = from[k1], *f2 = from[k2], *f3 = from[k3];
  const float *o0 = own[0], *o1 = own[k1], *o2 = own[k2], *o3 = own[k3];
  float* __restrict s0 = sums[0];
  float* __restrict s1 = sums[k1];
  float* __restrict s2 = sums[k2];
  float* __restrict s3 = sums[k3];
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const float w = weight[x] < kLeastWeight ? 0.0f : weight[x];
    total[x] += w;
    s0[x] += w * (f0[x] - o0[x]);
    if constexpr (kTargets > 1) s1[x] += w * (f1[x] - o1[x]);
    if constexpr (kTargets > 2) s2[x] += w * (f2[x] - o2[x]);
    if constexpr (kTargets > 3) s3[x] += w * (f3[x] - o3[x]);
  }
}

// to += from, and from = 0.
SPOOL_VECTOR_CLONES
void move_sums(float* __restrict from, std::size_t count, double* __restrict to) {
  for (std::size_t i = 0; i < count; ++i) {
    to[i] += static_cast<double>(from[i]);
    from[i] = 0.0f;
  }
}

// A weighted sum: of one row of offsets in float, of all rows in double. Of targets it is of what
// they differ from the piece's own, so that alike pieces stay what they are to the last bit of a
// double, and the result lies between what it is made of.
struct Sum {
  Image<float> row;
  Plane all;
  void finish_row() { move_sums(row.pixels().data(), row.size(), all.pixels().data()); }
};

// `factor` times the part of an image around a tile, mirrored where it leaves the image, at most
// `most` and at least -most; rows are whole lanes long, zero beyond the part.
Image<float> around(const Plane& image, const Rectangle& tile, int border, double factor,
                    double most) {
  const int width = tile.width() + 2 * border;
  // The last offset reads whole lanes from there on.
  Image<float> result(whole_lanes(width + kLanes), tile.height() + 2 * border);
  const int x0 = tile.x0 - border;
  for (int y = 0; y < result.height(); ++y) {
    const double* from = image.row(extend_symmetric(y + tile.y0 - border, image.height())).data();
    float* to = result.row(y).data();
    const auto copy = [&](int x, int source) {
      to[x] = static_cast<float>(std::clamp(factor * from[source], -most, most));
    };
    const int inside0 = std::clamp(-x0, 0, width);
    const int inside1 = std::clamp(image.width() - x0, inside0, width);
    for (int x = 0; x < inside0; ++x)
      copy(x, extend_symmetric(x0 + x, image.width()));
    for (int x = inside0; x < inside1; ++x)
      copy(x, x0 + x);
    for (int x = inside1; x < width; ++x)
      copy(x, extend_symmetric(x0 + x, image.width()));
  }
  return result;
}

// One tile of the result; every piece's sum runs over the offsets in the same order.
class Tile {
 public:
  Tile(const GuidedTargets& guided, const PatchFilterOptions& options, const Rectangle& tile)
      : guided_(guided),
        options_(options),
        tile_(tile),
        width_(tile.width()),
        height_(tile.height()),
        side_(2 * options.patch + 1),
        noise_(static_cast<float>(options.alpha / (options.kappa * options.kappa))),
        distances_(side_, whole_lanes(width_ + 2 * options.patch)),
        weights_(side_, whole_lanes(width_)) {
    const HalfImage& guide = *guided.guide;
    const int border = options.window + 2 * options.patch;
    for (std::size_t c = 0; c < 3; ++c) {
      a_[c] = around(guide.mean[c], tile, border, 1.0, kMostMean);
      v_[c] = around(guide.variance[c], tile, border, options.kappa * options.kappa, kMostVariance);
    }
    for (const Plane* target : guided.targets) {
      from_.push_back(around(*target, tile, options.window, 1.0, kMostMean));
      sums_.push_back(empty_sum(0.0));
    }
    total_ = empty_sum(1.0);
    const int longest = whole_lanes(whole_lanes(width_ + 4 * options.patch) + side_);
    rows_.resize(static_cast<std::size_t>(2 * longest + kLanes));
    row_ = aligned(rows_);
    boxes_ = row_ + longest;
  }

  std::vector<Plane> run() {
    const int r = options_.window;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        if (dx != 0 || dy != 0) add_offset(dx, dy);
      }
      total_.finish_row();
      for (Sum& sum : sums_)
        sum.finish_row();
    }
    std::vector<Plane> means;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const Plane& target = *guided_.targets[i];
      Plane& mean = means.emplace_back(width_, height_);
      for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
          mean(x, y) = target(tile_.x0 + x, tile_.y0 + y) + sums_[i].all(x, y) / total_.all(x, y);
        }
      }
    }
    return means;
  }

 private:
  Sum empty_sum(double of_centre) const {
    const int width = whole_lanes(width_);
    return {Image<float>(width, height_), Plane(width, height_, of_centre)};
  }

  // Rows of the guide that p and q of the given offset read for row y of d2.
  GuideRow guide_row(int y, int dx, int dy) const {
    GuideRow row;
    const int r = options_.window;
    for (std::size_t c = 0; c < 3; ++c) {
      row.a[c] = &a_[c](r + dx, y + r + dy);
      row.v[c] = &v_[c](r + dx, y + r + dy);
    }
    return row;
  }

  // row_ becomes a row of boxes that end with it; before there are `side` rows, of no meaning.
  void box(RowRing& ring, float scale, int width) {
    if (side_ == kUsualSide) {
      box_row_of_usual_side(row_, ring.next(), scale, width, boxes_);
    } else {
      box_row_of_any_side(row_, ring.next(), side_, scale, width, boxes_);
    }
    std::swap(row_, boxes_);
  }

  // Row by row: distances, their boxes, weights, their boxes.
  void add_offset(int dx, int dy) {
    const int f = options_.patch;
    const float scale = 1.0f / static_cast<float>(side_ * side_);
    for (int y = 0; y < height_ + 4 * f; ++y) {
      distance_row(guide_row(y, 0, 0), guide_row(y, dx, dy), noise_, whole_lanes(width_ + 4 * f),
                   row_);
      box(distances_, scale / 3.0f, whole_lanes(width_ + 2 * f));
      if (y < 2 * f) continue;
      weights_of_distances(row_, whole_lanes(width_ + 2 * f));
      box(weights_, scale, whole_lanes(width_));
      if (y >= 4 * f) add_row(y - 4 * f, dx, dy);
    }
  }

  // row_ holds the weights of row y with the row of the offset.
  void add_row(int y, int dx, int dy) {
    std::array<const float*, kMostTargets> from, own;
    std::array<float*, kMostTargets> sums;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      from[i] = &from_[i](options_.window + dx, y + options_.window + dy);
      own[i] = &from_[i](options_.window, y + options_.window);
      sums[i] = sums_[i].row.row(y).data();
    }
    (sums_.size() == 1   ? add_targets<1>
     : sums_.size() == 2 ? add_targets<2>
     : sums_.size() == 3 ? add_targets<3>
                         : add_targets<4>)(row_, whole_lanes(width_), total_.row.row(y).data(),
                                           from.data(), own.data(), sums.data());
  }

  const GuidedTargets& guided_;
  const PatchFilterOptions& options_;
  Rectangle tile_;
  int width_, height_, side_;
  float noise_;                        // alpha / kappa^2
  std::array<Image<float>, 3> a_, v_;  // of the guide, 2 patch + window beyond the tile
  std::vector<Image<float>> from_;     // targets, window beyond the tile
  std::vector<Sum> sums_;              // of the tile
  Sum total_;                          // of the weights, the centre's is 1
  RowRing distances_, weights_;        // sums along rows
  std::vector<float> rows_;            // row_ and boxes_
  float *row_ = nullptr, *boxes_ = nullptr;
};

}  // namespace

std::vector<Plane> filter_tile(const GuidedTargets& guided, const PatchFilterOptions& options,
                               const Rectangle& tile) {
  SPOOL_CHECK_LE(guided.targets.size(), kMostTargets);
  return Tile(guided, options, tile).run();
}

}  // namespace spool
