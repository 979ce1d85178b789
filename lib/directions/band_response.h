// The directional filter bank in the frequency plane.
#pragma once

#include <span>
#include <vector>

#include "lib/directions/directional_filter_bank.h"

namespace spool {

// The frequency response of each band of a bank: real, on a grid of n x n
// frequencies w = 2 pi (i, j) / n.
class BankResponse {
 public:
  BankResponse(const BankOptions& options, int n);
  // bands[b] at frequency (i, j), 0 <= i, j < n.
  void at(int i, int j, std::span<double> bands) const;

 private:
  double split(int px, int py, int qx, int qy, int i, int j) const;  // sigma(p.w) sigma(q.w)

  int levels_ = 0, n_ = 0, dilation_ = 1;
  std::vector<double> sigma_;  // sigma(2 pi m / n), m < 2 n
};

}  // namespace spool
