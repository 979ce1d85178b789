#include "lib/statistics/film_covariance.h"

#include <cmath>

#include "lib/core/parallel.h"
#include "lib/statistics/transformed_moments.h"

namespace spool {
namespace {

// Of the piece's middle, in [-1/2, 1/2): `film` is the place in the pixel.
double from_middle(float film, int pieces_per_side) {
  const double u = pieces_per_side * static_cast<double>(film);
  return u - std::floor(u) - 0.5;
}

}  // namespace

FilmCovariance film_covariance(const SamplePool& pool, const CountImage& n, double unit,
                               double lambda, const RgbImage& mean) {
  FilmCovariance sums{make_rgb(n.width(), n.height()), make_rgb(n.width(), n.height())};
  const int q = pool.pieces_per_side();
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t p = n.index(x, y);
      for (int i = 0; i < n[p]; ++i) {
        const Rgb sample = pool.sample(x, y, i);
        const FilmPosition film = pool.film(x, y, i);
        const double right = from_middle(film.x, q), down = from_middle(film.y, q);
        for (std::size_t c = 0; c < 3; ++c) {
          const double d =
              transformed_sample(unit * static_cast<double>(sample[c]), lambda) - mean[c][p];
          sums.x[c][p] += d * right;
          sums.y[c][p] += d * down;
        }
      }
    }
  });
  return sums;
}

}  // namespace spool
