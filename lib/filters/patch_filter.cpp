#include "lib/filters/patch_filter.h"

#include <algorithm>
#include <cmath>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr double kEpsilon = 1e-10;
constexpr double kLeastWeight = 0.05;

// Mirrored border, so that the loops need no test.
Plane mirrored(const Plane& image, int border) {
  Plane result(image.width() + 2 * border, image.height() + 2 * border);
  parallel_rows(0, result.height(), [&](int y) {
    const int from = extend_symmetric(y - border, image.height());
    for (int x = 0; x < result.width(); ++x)
      result(x, y) = image(extend_symmetric(x - border, image.width()), from);
  });
  return result;
}

RgbImage mirrored(const RgbImage& image, int border) {
  return {mirrored(image[0], border), mirrored(image[1], border), mirrored(image[2], border)};
}

std::vector<Plane> mirrored(std::span<const Plane> images, int border) {
  std::vector<Plane> result;
  for (const Plane& image : images)
    result.push_back(mirrored(image, border));
  return result;
}

// Mean over the (2 radius + 1)^2 window; `out` is smaller than `in` by radius on each side.
void box_mean(const Plane& in, int radius, Plane& rows, Plane& out) {
  const int size = 2 * radius + 1;
  parallel_rows(0, in.height(), [&](int y) {
    const double* from = in.row(y).data();
    double* __restrict to = rows.row(y).data();
    for (int x = 0; x < out.width(); ++x)
      to[x] = from[x];
    for (int i = 1; i < size; ++i) {
      for (int x = 0; x < out.width(); ++x)
        to[x] += from[x + i];
    }
  });
  const double scale = 1.0 / (size * size);
  parallel_rows(0, out.height(), [&](int y) {
    double* __restrict to = out.row(y).data();
    std::copy_n(rows.row(y).data(), out.width(), to);
    for (int j = 1; j < size; ++j) {
      const double* from = rows.row(y + j).data();
      for (int x = 0; x < out.width(); ++x)
        to[x] += from[x];
    }
    for (int x = 0; x < out.width(); ++x)
      to[x] *= scale;
  });
}

}  // namespace

std::vector<Plane> filter_with_guide(std::span<const Plane> targets, const HalfImage& guide,
                                     const PatchFilterOptions& options) {
  const int width = targets[0].width(), height = targets[0].height();
  const int r = options.window, f = options.patch;
  // d2 is wanted 2 f beyond the image, and q is r beyond that.
  const int border = r + 2 * f;
  const RgbImage a = mirrored(guide.mean, border), v = mirrored(guide.variance, border);
  const std::vector<Plane> from = mirrored(targets, border);
  Plane d2(width + 4 * f, height + 4 * f), d2_rows(d2.width(), d2.height());
  Plane w(width + 2 * f, height + 2 * f), w_rows(w.width(), w.height());
  Plane weight(width, height), total(width, height, 1.0);
  std::vector<Plane> out(targets.begin(), targets.end());
  const double kappa2 = options.kappa * options.kappa;

  for (int dy = -r; dy <= r; ++dy) {
    for (int dx = -r; dx <= r; ++dx) {
      if (dx == 0 && dy == 0) continue;  // weight 1, there already
      parallel_rows(0, d2.height(), [&](int y) {
        double* __restrict to = d2.row(y).data();
        std::fill_n(to, d2.width(), 0.0);
        for (std::size_t c = 0; c < 3; ++c) {
          const double* ap = &a[c](r, y + r);
          const double* aq = &a[c](r + dx, y + r + dy);
          const double* vp = &v[c](r, y + r);
          const double* vq = &v[c](r + dx, y + r + dy);
          for (int x = 0; x < d2.width(); ++x) {
            const double difference = ap[x] - aq[x];
            to[x] += (difference * difference - options.alpha * (vp[x] + std::min(vq[x], vp[x]))) /
                     (kEpsilon + kappa2 * (vp[x] + vq[x]));
          }
        }
        for (int x = 0; x < d2.width(); ++x)
          to[x] /= 3.0;
      });
      box_mean(d2, f, d2_rows, w);
      parallel_rows(0, w.height(), [&](int y) {
        for (double& value : w.row(y))
          value = std::exp(-std::max(0.0, value));
      });
      box_mean(w, f, w_rows, weight);
      parallel_rows(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
          const double share = weight(x, y);
          if (share < kLeastWeight) continue;
          total(x, y) += share;
          for (std::size_t c = 0; c < out.size(); ++c) {
            out[c](x, y) += share * from[c](x + border + dx, y + border + dy);
          }
        }
      });
    }
  }
  for (Plane& channel : out) {
    for (std::size_t i = 0; i < channel.size(); ++i)
      channel[i] /= total[i];
  }
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
