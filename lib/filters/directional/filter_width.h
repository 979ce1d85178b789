// How wide the filter of each piece is along each direction.
//
//   q_i     = E_i / max_j E_j
//   delta_i = max(0.25, sigma_max 2^k (rho + (1 - rho) q_i^gamma_d))      [LiuZheng (section 4)]
//
// k is the piece's own level; level 0 has no filter and its deltas stay 0. Where no direction
// stands out of the noise every q_i is 1. T (float or double) is the precision of bands, energies
// and widths. Slow twin: tests/reference/anisotropic_filter_reference.h.
#pragma once

#include <vector>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/view.h"
#include "lib/filters/directional/options.h"
#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {

template <class T>
struct FilterWidths {
  std::vector<double> beta;     // spatial directions in degrees, ascending in [0, 180)
  std::vector<Image<T>> delta;  // [direction][y][x] standard deviation, pieces
  Plane dominant;               // [y][x] beta of the largest energy; NaN where round or level 0
};

// `variance`: of the unfiltered piece means, exposed; `level`: from filter_size.h.
// Views: band_energy.k.i, delta.i.
template <class T>
FilterWidths<T> filter_widths(const Pyramid& pyramid, const Plane& variance,
                              const CountImage& level, const DirectionalOptions& options,
                              Views* views, GuardCounts& guards);

}  // namespace spool
