#include "lib/directions/band_response.h"

#include <numbers>

#include "lib/directions/bank_stages.h"

namespace spool {

BankResponse::BankResponse(const BankOptions& options, int n)
    : levels_(options.levels), n_(n), dilation_(options.dilation) {
  for (int m = 0; m < 2 * n; ++m)
    sigma_.push_back(sign_response(options.taps, 2.0 * std::numbers::pi * m / n));
}

double BankResponse::split(int px, int py, int qx, int qy, int i, int j) const {
  const auto sigma = [&](int vx, int vy) {
    const int m = dilation_ * (vx * i + vy * j) % (2 * n_);
    return sigma_[static_cast<std::size_t>(m < 0 ? m + 2 * n_ : m)];
  };
  return sigma(px, py) * sigma(qx, qy);
}

void BankResponse::at(int i, int j, std::span<double> bands) const {
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
  const auto divide = [&](double wedge, const BankStage& stage, double& to_plus, double& to_minus) {
    const double share = plus(stage);
    to_plus = wedge * share;
    to_minus = wedge * (1.0 - share);
  };
  divide(horizontal * positive, split_of_horizontal(1), bands[1], bands[0]);
  divide(horizontal * negative, split_of_horizontal(-1), bands[6], bands[7]);
  divide(vertical * positive, split_of_vertical(1), bands[2], bands[3]);
  divide(vertical * negative, split_of_vertical(-1), bands[5], bands[4]);
}

}  // namespace spool
