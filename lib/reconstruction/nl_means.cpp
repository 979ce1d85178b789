#include "lib/reconstruction/nl_means.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/reconstruction/piece_estimates.h"
#include "lib/reconstruction/variance_option.h"

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

struct Halves {
  PieceStatistics a, b;
};

Halves split_halves(const PieceStatistics& statistics, const SamplePool& pool) {
  const int width = statistics.width(), height = statistics.height();
  PieceStatistics empty;
  empty.pieces_per_side = statistics.pieces_per_side;
  empty.n = CountImage(width, height);
  empty.mean = make_rgb(width, height);
  empty.m2 = make_rgb(width, height);
  Halves halves{empty, empty};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t p = statistics.n.index(x, y);
      for (int s = 0; s < statistics.n[p]; ++s) {
        PieceStatistics& half = s % 2 == 0 ? halves.a : halves.b;
        const Rgb radiance = pool.sample(x, y, s);
        ++half.n[p];
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = static_cast<double>(radiance[c]);
          const double delta = value - half.mean[c][p];
          half.mean[c][p] += delta / half.n[p];
          half.m2[c][p] += delta * (value - half.mean[c][p]);
        }
      }
    }
  });
  return halves;
}

bool any_sample(const CountImage& n) {
  return std::any_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k > 0; });
}

Result<HalfImage> estimate_half(const PieceStatistics& half, const NlMeansOptions& options,
                                double exposure) {
  GuardCounts counted_as_a_whole;
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(half, {options.var_mode, options.nu0, options.key}, exposure,
                               counted_as_a_whole));
  HalfImage image{std::move(pieces.mean), std::move(pieces.variance)};
  for (std::size_t c = 0; c < 3; ++c) {
    for (double& v : image.mean[c].pixels())
      v *= exposure;
    for (double& v : image.variance[c].pixels())
      v *= exposure * exposure;
  }
  return image;
}

}  // namespace

RgbImage filter_with_guide(const RgbImage& target, const HalfImage& guide,
                           const NlMeansOptions& options) {
  const int width = target[0].width(), height = target[0].height();
  const int r = options.window, f = options.patch;
  // d2 is wanted 2 f beyond the image, and q is r beyond that.
  const int border = r + 2 * f;
  const RgbImage a = mirrored(guide.mean, border), v = mirrored(guide.variance, border);
  const RgbImage from = mirrored(target, border);
  Plane d2(width + 4 * f, height + 4 * f), d2_rows(d2.width(), d2.height());
  Plane w(width + 2 * f, height + 2 * f), w_rows(w.width(), w.height());
  Plane weight(width, height), total(width, height, 1.0);
  RgbImage out = target;
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
          for (std::size_t c = 0; c < 3; ++c) {
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

OptionTable<NlMeansOptions> nl_means_option_table() {
  using O = NlMeansOptions;
  return {
      integer_option<O>("window", &O::window, 1, 64, "radius searched, pixels"),
      integer_option<O>("patch", &O::patch, 0, 16, "radius of the patches compared, pixels"),
      number_option<O>("kappa", &O::kappa, 1e-3, 100.0, "damping: larger filters more"),
      number_option<O>("alpha", &O::alpha, 0.0, 10.0, "share of the noise taken off a distance"),
      var_mode_option(&O::var_mode),
      nu0_option(&O::nu0),
      number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the exposed luminance"),
  };
}

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const ReconstructionContext&,
                                            const NlMeansOptions& options) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  if (!any_sample(statistics.n)) {
    return fail(ErrorCode::kData,
                "selection: no piece has a sample: raise the budget or check the counts");
  }
  for (const std::int32_t n : statistics.n.pixels())
    result.guards.add(Guard::kEmptyPiece, n == 0 ? 1 : 0);
  const double exposure = analysis_exposure(statistics, options.key, true, result.guards);
  Halves halves = split_halves(statistics, pool);
  if (!any_sample(halves.b.n)) halves.b = halves.a;  // one sample a piece: nothing to cross
  SPOOL_ASSIGN(const HalfImage a, estimate_half(halves.a, options, exposure));
  SPOOL_ASSIGN(const HalfImage b, estimate_half(halves.b, options, exposure));
  const RgbImage filtered_a = filter_with_guide(a.mean, b, options);
  const RgbImage filtered_b = filter_with_guide(b.mean, a, options);
  RgbImage image = filtered_a;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i) {
      const double na = std::max(1, halves.a.n[i]), nb = halves.b.n[i];
      image[c][i] = (na * filtered_a[c][i] + nb * filtered_b[c][i]) / (na + nb) / exposure;
    }
  }
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

ReconstructorMethod<NlMeansOptions> nl_means_method() {
  return {"nl_means",
          "patches that look alike are averaged, weights from the other half of the samples",
          false,
          nl_means_option_table(),
          {{"", {}}},
          reconstruct_nl_means};
}

}  // namespace spool
