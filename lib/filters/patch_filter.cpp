#include "lib/filters/patch_filter.h"

#include <algorithm>

#include "lib/core/exponential.h"
#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr double kEpsilon = 1e-10;
constexpr double kLeastWeight = 0.05;

// Pieces whose distances, weights and sums are computed together: all that an offset reads and
// writes stays in the cache of one core.
constexpr int kTile = 80;

// d2 before its boxes, for `width` pieces p of a row; q is the piece at the offset.
// a, v: pointers to the row of each channel.
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
  const auto term = [&](double ap, double aq, double vp, double vq) {
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

// Weights below the least one count as 0, which adds nothing.
SPOOL_VECTOR_CLONES
void drop_small_weights(double* __restrict weight, int width, double* __restrict total) {
  for (int x = 0; x < width; ++x) {
    weight[x] = weight[x] < kLeastWeight ? 0.0 : weight[x];
    total[x] += weight[x];
  }
}

SPOOL_VECTOR_CLONES
void add_weighted(const double* weight, const double* from, int width, double* __restrict sum) {
  for (int x = 0; x < width; ++x)
    sum[x] += weight[x] * from[x];
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
  Tile(std::span<const Plane> targets, const HalfImage& guide, const PatchFilterOptions& options,
       const Rectangle& tile)
      : options_(options), tile_(tile), width_(tile.width()), height_(tile.height()) {
    const int border = options.window + 2 * options.patch;
    for (std::size_t c = 0; c < 3; ++c) {
      a_[c] = around(guide.mean[c], tile, border);
      v_[c] = around(guide.variance[c], tile, border);
    }
    for (const Plane& target : targets) {
      from_.push_back(around(target, tile, options.window));
      sums_.push_back(around(target, tile, 0));  // the centre, with weight 1
    }
    total_ = Plane(width_, height_, 1.0);
    distance_sums_ = Plane(width_ + 2 * options.patch, height_ + 4 * options.patch);
    weight_sums_ = Plane(width_, height_ + 2 * options.patch);
    row_.resize(static_cast<std::size_t>(width_ + 4 * options.patch));
  }

  void run(std::vector<Plane>& out) {
    const int r = options_.window;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        if (dx != 0 || dy != 0) add_offset(dx, dy);
      }
    }
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      for (int y = 0; y < height_; ++y) {
        double* sum = sums_[i].row(y).data();
        divide(sum, total_.row(y).data(), width_);
        std::copy_n(sum, width_, &out[i](tile_.x0, tile_.y0 + y));
      }
    }
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
      drop_small_weights(row, width_, total_.row(y).data());
      for (std::size_t i = 0; i < sums_.size(); ++i) {
        add_weighted(row, &from_[i](options_.window + dx, y + options_.window + dy), width_,
                     sums_[i].row(y).data());
      }
    }
  }

  const PatchFilterOptions& options_;
  Rectangle tile_;
  int width_ = 0, height_ = 0;
  RgbImage a_, v_;                     // of the guide, 2 patch + window beyond the tile
  std::vector<Plane> from_;            // targets, window beyond the tile
  std::vector<Plane> sums_;            // of the tile
  Plane total_;                        // weights added so far
  Plane distance_sums_, weight_sums_;  // along rows
  std::vector<double> row_;
};

}  // namespace

std::vector<Plane> filter_with_guide(std::span<const Plane> targets, const HalfImage& guide,
                                     const PatchFilterOptions& options) {
  const int width = targets[0].width(), height = targets[0].height();
  std::vector<Plane> out(targets.size(), Plane(width, height));
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  parallel_for(
      static_cast<std::size_t>(across) * static_cast<std::size_t>(down), [&](std::size_t i) {
        const int x0 = static_cast<int>(i) % across * kTile;
        const int y0 = static_cast<int>(i) / across * kTile;
        const Rectangle tile = {x0, y0, std::min(x0 + kTile, width), std::min(y0 + kTile, height)};
        Tile(targets, guide, options, tile).run(out);
      });
  return out;
}

RgbImage filter_with_guide(const RgbImage& target, const HalfImage& guide,
                           const PatchFilterOptions& options) {
  std::vector<Plane> out = filter_with_guide(std::span<const Plane>(target), guide, options);
  return {std::move(out[0]), std::move(out[1]), std::move(out[2])};
}

OptionTable<PatchFilterOptions> patch_filter_option_table() {
  using O = PatchFilterOptions;
  return {
      integer_option<O>("window", &O::window, 1, 64, "radius searched, pixels"),
      integer_option<O>("patch", &O::patch, 0, 16, "radius of the patches compared, pixels"),
      number_option<O>("kappa", &O::kappa, 1e-3, 100.0, "damping: larger filters more"),
      number_option<O>("alpha", &O::alpha, 0.0, 10.0, "share of the noise taken off a distance"),
  };
}

}  // namespace spool
