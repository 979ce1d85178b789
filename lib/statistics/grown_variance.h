// Variances that enough pieces vouch for.
//
//   W_r = the window of radius r around a piece, cut at the border;   r = 1, 2, 4, ... <= largest
//   v_r = mean of v over W_r,   N_r = (sum of v)^2 / sum of v^2,   v_0 = 0
//   enough_r = (N_r - 10) / 10 within 0 .. 1; 1 of the last radius
//   alike_r = 2 - (variance of the means over W_r) / v_r within 0 .. 1; 1 without means
//             and of one piece
//   out = sum over r of left_r (alike_r enough_r v_r + (1 - alike_r) v_(r-1))
//   left_1 = 1, that of the next radius is left_r alike_r (1 - enough_r)
//
// N counts the pieces that a mean rests on. Where few samples carry the light most pieces have no
// variance by chance, and N_r stays small until the window holds some bright ones. Means that
// differ by more than their own noise are of different things, a wall and a lamp: no window grows
// over both. Of n samples of which one is bright, variance and square of the mean are equal, so
// rare light is alike. Slow twin: tests/reference/grown_variance_reference.h.
#pragma once

#include "lib/core/image.h"

namespace spool {

// `variance` [y][x]: finite, >= 0. `largest`: radius in pieces, >= 1. `mean`: what it is the
// variance of.
Plane grown_variance(const Plane& variance, int largest, const Plane* mean = nullptr);

}  // namespace spool
