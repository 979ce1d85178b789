#include "lib/statistics/transformed_moments.h"

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"

namespace spool {
namespace {

double power(double x, double lambda) {
  if (lambda == 0.5) return std::sqrt(x);
  if (lambda == 0.25) return std::sqrt(std::sqrt(x));
  return std::pow(x, lambda);
}

// Of the piece's middle, in [-1/2, 1/2): `film` is the place in the pixel.
double from_middle(float film, int pieces_per_side) {
  const double u = pieces_per_side * static_cast<double>(film);
  return u - std::floor(u) - 0.5;
}

double transformed_sample(double x, double lambda) {
  return lambda == 1.0 ? x : (power(std::max(x, 0.0), lambda) - 1.0) / lambda;
}

}  // namespace

TransformedMoments transformed_moments(const SamplePool& pool, const CountImage& n, double unit,
                                       double lambda, HighestMoment highest) {
  SPOOL_CHECK(lambda > 0.0);
  const auto zeros = [&] { return make_rgb(n.width(), n.height()); };
  const bool fourth = highest == HighestMoment::kFourth;
  TransformedMoments moments{zeros(), zeros(), zeros(), fourth ? zeros() : RgbImage{}};
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const std::size_t p = n.index(x, y);
      for (int i = 0; i < n[p]; ++i) {
        const Rgb sample = pool.sample(x, y, i);
        for (std::size_t c = 0; c < 3; ++c) {
          double &mean = moments.mean[c][p], &m2 = moments.m2[c][p], &m3 = moments.m3[c][p];
          const double value = transformed_sample(unit * static_cast<double>(sample[c]), lambda);
          const double delta = value - mean, k = i + 1;
          const double share = delta / k, term = delta * share * i;
          if (fourth) {
            moments.m4[c][p] += term * share * share * (k * k - 3.0 * k + 3.0) +
                                6.0 * share * share * m2 - 4.0 * share * m3;
          }
          m3 += term * share * (i - 1) - 3.0 * share * m2;
          m2 += term;
          mean += share;
        }
      }
    }
  });
  return moments;
}

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
