#include "lib/kernels/patch_tile.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lib/core/exponential.h"
#include "lib/core/extend.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr double kEpsilon = 1e-10;
constexpr double kLeastWeight = 0.05;
constexpr std::size_t kMostTargets = 4;

// d2 before its boxes, for `width` pieces p of a row; q is the piece at the offset. The channels
// are brought to one denominator: a division costs as much as all the rest. a, v: pointers to the
// row of each channel.
struct GuideRow {
  const double* a[3];
  const double* v[3];
};

SPOOL_VECTOR_CLONES
void distance_row(const GuideRow& p, const GuideRow& q, double alpha, double kappa2, int width,
                  double* __restrict to) {
  const double *a0 = p.a[0], *a1 = p.a[1], *a2 = p.a[2];
  const double *b0 = q.a[0], *b1 = q.a[1], *b2 = q.a[2];
  const double *v0 = p.v[0], *v1 = p.v[1], *v2 = p.v[2];
  const double *u0 = q.v[0], *u1 = q.v[1], *u2 = q.v[2];
  const auto term = [=](double ap, double aq, double vp, double vq) {
    const double difference = ap - aq;
    return (difference * difference - alpha * (vp + std::min(vq, vp))) /
           (kEpsilon + kappa2 * (vp + vq));
  };
  for (int x = 0; x < width; ++x) {
    to[x] = (term(a0[x], b0[x], v0[x], u0[x]) + term(a1[x], b1[x], v1[x], u1[x]) +
             term(a2[x], b2[x], v2[x], u2[x])) /
            3.0;
  }
}

// to[x] = from[x] + ... + from[x + terms - 1], in that order.
SPOOL_VECTOR_CLONES
void sum_along_row(const double* from, int terms, int width, double* __restrict to) {
  if (terms == 7) {  // the usual patch, without stores in between
    for (int x = 0; x < width; ++x) {
      to[x] = from[x] + from[x + 1] + from[x + 2] + from[x + 3] + from[x + 4] + from[x + 5] +
              from[x + 6];
    }
    return;
  }
  std::copy_n(from, width, to);
  for (int i = 1; i < terms; ++i) {
    for (int x = 0; x < width; ++x)
      to[x] += from[x + i];
  }
}

// to = scale (row 0 + row 1 + ...), in that order.
SPOOL_VECTOR_CLONES
void sum_of_rows(const double* from, std::ptrdiff_t stride, int terms, double scale, int width,
                 double* __restrict to) {
  if (terms == 7) {
    for (int x = 0; x < width; ++x) {
      const double* f = from + x;
      to[x] = (f[0] + f[stride] + f[2 * stride] + f[3 * stride] + f[4 * stride] + f[5 * stride] +
               f[6 * stride]) *
              scale;
    }
    return;
  }
  std::copy_n(from, width, to);
  for (int j = 1; j < terms; ++j) {
    const double* f = from + j * stride;
    for (int x = 0; x < width; ++x)
      to[x] += f[x];
  }
  for (int x = 0; x < width; ++x)
    to[x] *= scale;
}

SPOOL_VECTOR_CLONES
void weights_of_distances(double* __restrict row, int width) {
  for (int x = 0; x < width; ++x)
    row[x] = exp_negative(row[x] > 0.0 ? row[x] : 0.0);
}

// sums[i] += weight * from[i] and total += weight; weights below the least one count as 0, which
// adds nothing.
template <int kTargets>
SPOOL_VECTOR_CLONES void add_targets(double* __restrict weight, int width, double* __restrict total,
                                     const double* const* from, double* const* sums) {
  static_assert(kTargets >= 1 && kTargets <= 4);
  const double *f0 = from[0], *f1 = from[kTargets > 1 ? 1 : 0], *f2 = from[kTargets > 2 ? 2 : 0],
               *f3 = from[kTargets > 3 ? 3 : 0];
  double* __restrict s0 = sums[0];
  double* __restrict s1 = sums[kTargets > 1 ? 1 : 0];
  double* __restrict s2 = sums[kTargets > 2 ? 2 : 0];
  double* __restrict s3 = sums[kTargets > 3 ? 3 : 0];
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const double w = weight[x] < kLeastWeight ? 0.0 : weight[x];
    total[x] += w;
    s0[x] += w * f0[x];
    if constexpr (kTargets > 1) s1[x] += w * f1[x];
    if constexpr (kTargets > 2) s2[x] += w * f2[x];
    if constexpr (kTargets > 3) s3[x] += w * f3[x];
  }
}

SPOOL_VECTOR_CLONES
void divide(double* __restrict sum, const double* total, int width) {
  for (int x = 0; x < width; ++x)
    sum[x] /= total[x];
}

// The part of an image around a tile, mirrored where it leaves the image.
Plane around(const Plane& image, const Rectangle& tile, int border) {
  Plane result(tile.width() + 2 * border, tile.height() + 2 * border);
  std::vector<int> columns(static_cast<std::size_t>(result.width()));
  for (int x = 0; x < result.width(); ++x)
    columns[static_cast<std::size_t>(x)] = extend_symmetric(x + tile.x0 - border, image.width());
  for (int y = 0; y < result.height(); ++y) {
    const double* from = image.row(extend_symmetric(y + tile.y0 - border, image.height())).data();
    double* to = result.row(y).data();
    for (int x = 0; x < result.width(); ++x)
      to[x] = from[columns[static_cast<std::size_t>(x)]];
  }
  return result;
}

// One tile of the result; every piece's sum runs over the offsets in the same order.
class Tile {
 public:
  Tile(const GuidedTargets& guided, const PatchFilterOptions& options, const Rectangle& tile)
      : options_(options), width_(tile.width()), height_(tile.height()) {
    const HalfImage& guide = *guided.guide;
    const int border = options.window + 2 * options.patch;
    for (std::size_t c = 0; c < 3; ++c) {
      a_[c] = around(guide.mean[c], tile, border);
      v_[c] = around(guide.variance[c], tile, border);
    }
    for (const Plane* target : guided.targets) {
      from_.push_back(around(*target, tile, options.window));
      sums_.push_back(around(*target, tile, 0));  // the centre, with weight 1
    }
    total_ = Plane(width_, height_, 1.0);
    distance_sums_ = Plane(width_ + 2 * options.patch, height_ + 4 * options.patch);
    weight_sums_ = Plane(width_, height_ + 2 * options.patch);
    row_.resize(static_cast<std::size_t>(width_ + 4 * options.patch));
  }

  std::vector<Plane> run() {
    const int r = options_.window;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        if (dx != 0 || dy != 0) add_offset(dx, dy);
      }
    }
    for (Plane& sums : sums_) {
      for (int y = 0; y < height_; ++y)
        divide(sums.row(y).data(), total_.row(y).data(), width_);
    }
    return std::move(sums_);
  }

 private:
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

  void add_offset(int dx, int dy) {
    const int f = options_.patch, side = 2 * f + 1;
    const double scale = 1.0 / (side * side);
    double* row = row_.data();
    for (int y = 0; y < height_ + 4 * f; ++y) {
      distance_row(guide_row(y, 0, 0), guide_row(y, dx, dy), options_.alpha,
                   options_.kappa * options_.kappa, width_ + 4 * f, row);
      sum_along_row(row, side, width_ + 2 * f, distance_sums_.row(y).data());
    }
    for (int y = 0; y < height_ + 2 * f; ++y) {
      sum_of_rows(distance_sums_.row(y).data(), distance_sums_.width(), side, scale, width_ + 2 * f,
                  row);
      weights_of_distances(row, width_ + 2 * f);
      sum_along_row(row, side, width_, weight_sums_.row(y).data());
    }
    for (int y = 0; y < height_; ++y) {
      sum_of_rows(weight_sums_.row(y).data(), weight_sums_.width(), side, scale, width_, row);
      add_row(y, dx, dy);
    }
  }

  // row_ holds the weights of row y with the row of the offset.
  void add_row(int y, int dx, int dy) {
    std::array<const double*, kMostTargets> from;
    std::array<double*, kMostTargets> sums;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      from[i] = &from_[i](options_.window + dx, y + options_.window + dy);
      sums[i] = sums_[i].row(y).data();
    }
    (sums_.size() == 1   ? add_targets<1>
     : sums_.size() == 2 ? add_targets<2>
     : sums_.size() == 3
         ? add_targets<3>
         : add_targets<4>)(row_.data(), width_, total_.row(y).data(), from.data(), sums.data());
  }

  const PatchFilterOptions& options_;
  int width_ = 0, height_ = 0;
  RgbImage a_, v_;                     // of the guide, 2 patch + window beyond the tile
  std::vector<Plane> from_;            // targets, window beyond the tile
  std::vector<Plane> sums_;            // of the tile
  Plane total_;                        // weights added so far
  Plane distance_sums_, weight_sums_;  // along rows
  std::vector<double> row_;
};

}  // namespace

std::vector<Plane> filter_tile(const GuidedTargets& guided, const PatchFilterOptions& options,
                               const Rectangle& tile) {
  SPOOL_CHECK_LE(guided.targets.size(), kMostTargets);
  return Tile(guided, options, tile).run();
}

}  // namespace spool
