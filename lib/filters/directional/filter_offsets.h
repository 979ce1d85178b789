// The neighbours of a piece inside its filter's region, and where each lies between the directions.
//
//   b = atan2(dy, dx) mod 180;  sector i: beta_i <= b < beta_{i+1}, the last one wraps by 180
//   t = (b - beta_i) / (beta_{i+1} - beta_i) in [0, 1)                     [LiuZheng (12)]
//
// Sectors are half-open, so b exactly on beta_i belongs to sector i with t = 0.
#pragma once

#include <span>
#include <vector>

#include "lib/filters/directional/options.h"

namespace spool {

struct Sector {
  int lower = 0, upper = 0;  // indices into beta
  double t = 0.0;
};

// `beta` ascending in [0, 180); b any finite angle in degrees.
Sector sector_of(double b, std::span<const double> beta);

// Eq 12: width at a sector from the widths of all directions (delta[i] of beta_i).
//   corrected  (1 - t) delta_lower + t delta_upper
//   literal    t delta_lower + (1 - t) delta_upper: discontinuous at every beta_i
double interpolated_width(const Sector& sector, std::span<const double> delta, Eq12 form);

// Weight of the lower direction, 1 - t or t.
double lower_weight(const Sector& sector, Eq12 form);

struct FilterOffset {
  int dx = 0, dy = 0;
  double squared_distance = 0.0;
  Sector sector;
};

// Offsets of the upper half plane (dy > 0, or dy = 0 and dx > 0) in row-major order; -offset has
// the same weight. level >= 1.
std::vector<FilterOffset> filter_offsets(int level, std::span<const double> beta,
                                         FilterWindow window);

int filter_radius(int level);  // of the region of diameter 2^level

}  // namespace spool
