#include "lib/directions/band_noise_gains.h"

#include <algorithm>
#include <complex>
#include <numbers>
#include <span>

#include "lib/directions/bank_stages.h"
#include "lib/directions/directional_filter_bank.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

using Complex = std::complex<double>;

// The frequency response of each band of a bank: real, on a grid of n x n
// frequencies w = 2 pi (i, j) / n.
class BankResponse {
 public:
  BankResponse(const BankOptions& options, int n)
      : levels_(options.levels), n_(n), dilation_(options.dilation) {
    for (int m = 0; m < 2 * n; ++m)
      sigma_.push_back(sign_response(options.taps, 2.0 * std::numbers::pi * m / n));
  }

  // bands[b] at frequency (i, j), 0 <= i, j < n.
  void at(int i, int j, std::span<double> bands) const {
    const auto plus = [&](const BankStage& stage) {
      return 0.5 * (1.0 + split(stage.p.x, stage.p.y, stage.q.x, stage.q.y, i, j));
    };
    if (levels_ == 0) {
      bands[0] = 1.0;
      return;
    }
    const double horizontal = plus(kHorizontalOrVertical), vertical = 1.0 - horizontal;
    if (levels_ == 1) {
      bands[0] = horizontal, bands[1] = vertical;
      return;
    }
    const double positive = plus(kDiagonal), negative = 1.0 - positive;
    if (levels_ == 2) {
      bands[0] = horizontal * positive, bands[3] = horizontal * negative;
      bands[1] = vertical * positive, bands[2] = vertical * negative;
      return;
    }
    const auto divide = [&](double wedge, const BankStage& stage, double& to_plus,
                            double& to_minus) {
      const double share = plus(stage);
      to_plus = wedge * share;
      to_minus = wedge * (1.0 - share);
    };
    divide(horizontal * positive, split_of_horizontal(1), bands[1], bands[0]);
    divide(horizontal * negative, split_of_horizontal(-1), bands[6], bands[7]);
    divide(vertical * positive, split_of_vertical(1), bands[2], bands[3]);
    divide(vertical * negative, split_of_vertical(-1), bands[5], bands[4]);
  }

 private:
  // sigma(p.w) sigma(q.w)
  double split(int px, int py, int qx, int qy, int i, int j) const {
    const auto sigma = [&](int vx, int vy) {
      const int m = dilation_ * (vx * i + vy * j) % (2 * n_);
      return sigma_[static_cast<std::size_t>(m < 0 ? m + 2 * n_ : m)];
    };
    return sigma(px, py) * sigma(qx, qy);
  }

  int levels_ = 0, n_ = 0, dilation_ = 1;
  std::vector<double> sigma_;  // sigma(2 pi m / n), m < 2 n
};

// Sum of squares of the bands of d_{level-1} for a delta at (x, y) of an n x n image.
void add_response_energy(const PyramidOptions& pyramid, const BankOptions& bank, int level,
                         const Taps& prefilter, int n, int x, int y, double weight,
                         std::vector<double>& gains) {
  Plane delta(n, n);
  delta(x, y) = 1.0;
  delta = convolve(delta, prefilter, 1, Extension::kPeriodic);
  const Plane detail = build_pyramid(delta, pyramid).detail[static_cast<std::size_t>(level - 1)];
  const std::vector<Plane> bands = directional_bands(detail, bank);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    double sum = 0.0;
    for (const double value : bands[i].pixels())
      sum += value * value;
    gains[i] += weight * sum;
  }
}

// sum_m taps(m) exp(-i w m D) at the n frequencies w = 2 pi j / n.
std::vector<Complex> response(const Taps& taps, int dilation, int n) {
  std::vector<Complex> result(static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) {
    for (int m = taps.first; m <= taps.last(); ++m) {
      const long long turns = static_cast<long long>(j) * m * dilation % n;
      const double angle = -2.0 * std::numbers::pi * static_cast<double>(turns) / n;
      result[static_cast<std::size_t>(j)] +=
          taps.values[static_cast<std::size_t>(m - taps.first)] * std::polar(1.0, angle);
    }
  }
  return result;
}

// Frequency response of d_{level-1}: before(wx) before(wy) (1 - lost(wx) lost(wy)).
struct DetailResponse {
  std::vector<Complex> before, lost;
};

DetailResponse detail_response(const PyramidOptions& pyramid, int level, const Taps& prefilter,
                               int n) {
  DetailResponse result{response(prefilter, 1, n), {}};
  for (int k = 0; k < level; ++k) {
    const FilterPair pair = filter_pair_at(pyramid.filter, pyramid.roles, k);
    const int dilation = pyramid_dilation(k);
    std::vector<Complex> h = response(pair.analysis, dilation, n);
    for (std::size_t j = 0; k + 1 < level && j < h.size(); ++j)
      result.before[j] *= h[j];
    if (k + 1 == level) {
      const std::vector<Complex> g = response(pair.synthesis, dilation, n);
      for (std::size_t j = 0; j < h.size(); ++j)
        h[j] *= 0.5 * g[j];
    }
    result.lost = std::move(h);
  }
  return result;
}

// Parseval: no response is longer than n, so n^2 frequencies give the exact sum of squares.
std::vector<double> gains_from_responses(const PyramidOptions& pyramid, const BankOptions& bank,
                                         int level, const Taps& prefilter, int n) {
  const DetailResponse detail = detail_response(pyramid, level, prefilter, n);
  const BankResponse directions(bank, n);
  std::vector<double> gains(static_cast<std::size_t>(band_count(bank)), 0.0);
  std::vector<double> row(gains.size()), bands(gains.size());
  for (int j = 0; j <= n / 2; ++j) {  // the other half is the conjugate
    std::fill(row.begin(), row.end(), 0.0);
    const auto y = static_cast<std::size_t>(j);
    for (int i = 0; i < n; ++i) {
      const auto x = static_cast<std::size_t>(i);
      const double energy =
          std::norm(detail.before[x] * detail.before[y] * (1.0 - detail.lost[x] * detail.lost[y]));
      directions.at(i, j, bands);
      for (std::size_t b = 0; b < bands.size(); ++b)
        row[b] += energy * bands[b] * bands[b];
    }
    const double weight = j == 0 || 2 * j == n ? 1.0 : 2.0;
    for (std::size_t b = 0; b < row.size(); ++b)
      gains[b] += weight * row[b];
  }
  for (double& gain : gains)
    gain /= static_cast<double>(n) * n;
  return gains;
}

}  // namespace

std::vector<double> band_noise_gains(const PyramidOptions& pyramid_options,
                                     const BankOptions& bank_options, int level,
                                     const Taps& prefilter) {
  SPOOL_CHECK_GE(level, 1);
  PyramidOptions pyramid = pyramid_options;
  BankOptions bank = bank_options;
  pyramid.levels = level;
  pyramid.extension = Extension::kPeriodic;
  bank.extension = Extension::kPeriodic;

  // A period that holds the whole response, so that nothing wraps onto itself.
  PyramidOptions open = pyramid;
  open.extension = Extension::kClamp;
  const int far = 1 << 20;
  std::vector<Rectangle> coarse, detail;
  pyramid_influence({far, far, far + 1, far + 1}, {0, 0, 2 * far, 2 * far}, open, coarse, detail);
  const Rectangle reach = detail.back();
  const int pairs = static_cast<int>(sign_coefficients(bank.taps).size());
  const int bank_reach = bank.levels * (2 * pairs - 1) * bank.dilation;
  const int prefilter_reach = static_cast<int>(prefilter.values.size());
  const int cell = 2 * pyramid_dilation(level - 1);  // period of the phases
  const int n = (reach.width() + prefilter_reach + 2 * bank_reach + 3 * cell) / cell * cell;

  if (pyramid.detail == LaplacianDetail::kCycleSpun)
    return gains_from_responses(pyramid, bank, level, prefilter, n);
  std::vector<double> gains(static_cast<std::size_t>(band_count(bank)), 0.0);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      add_response_energy(pyramid, bank, level, prefilter, n, i * cell / 2, j * cell / 2, 0.25,
                          gains);
    }
  }
  return gains;
}

}  // namespace spool
