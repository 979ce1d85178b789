// Variances that enough pieces vouch for.
//
//   W_r = the window of radius r around a piece, cut at the border;   r = 1, 2, 4, ... <= largest
//   N_r = (sum of v over W_r)^2 / sum of v^2 over W_r
//   share_r = (N_r - 10) / 10 within 0 .. 1; that of the last radius 1
//   out = the means of v over W_r, each with its share of what the smaller windows left
//
// N counts the pieces that a mean rests on. Where few samples carry the light most pieces have no
// variance by chance, and N_r stays small until the window holds some bright ones.
// Slow twin: tests/reference/grown_variance_reference.h.
#pragma once

#include "lib/core/image.h"

namespace spool {

// `variance` [y][x]: finite, >= 0. `largest`: radius in pieces, >= 1.
Plane grown_variance(const Plane& variance, int largest);

}  // namespace spool
