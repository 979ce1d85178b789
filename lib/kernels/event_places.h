// Whether events are spread over a window or stand in places of their own, and where these are:
// the pair correlation of point processes [IllianEtAl08, ch. 4], of pairs of independent groups of
// samples, and the density of events beside that of the window.
//
//   c_k = density of the events of group k,   sums over j != k
//   s = (G_far * sum (G_near * c_j)(G_near * c_k) + e) / (sum (G_far * c_j)(G_far * c_k) + e)
//   e = 10 / (2 pi far^2 . 4 pi near^2 m^2)
//   d = sum (G_near * c_k) / sum (G_far * c_k)
//
// s is 1 where events fall anywhere alike, 1/f where all of them fall on a share f of the window.
// No pair is of one group, so the noise of a group is not taken for a place. e stands for ten pairs
// by chance: few events say nothing, and none give 1. Slow twin:
// tests/reference/event_places_reference.h.
#pragma once

#include <vector>

#include "lib/core/image.h"

namespace spool {

struct EventPlaces {
  Plane correlation;  // s [y][x]
  Plane density;      // d [y][x]; 0 where the window has no event
};

// `groups` [k][y][x]: share of a group's samples that are events, 0 .. 1, of >= 2 groups.
// near, far: standard deviations, pixels. m: mean number of samples of a group in a pixel.
EventPlaces event_places(const std::vector<Plane>& groups, double near, double far, double m);

}  // namespace spool
