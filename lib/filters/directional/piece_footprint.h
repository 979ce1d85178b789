// With which weights a pixel was made of the means of the pieces around it: those of eqs 10-12 over
// the base image, taken apart into the means that the base image mixed.
#pragma once

#include "lib/core/footprint.h"
#include "lib/filters/directional/filter_width.h"
#include "lib/filters/directional/options.h"

namespace spool {

template <class T>
struct FootprintInput {
  const RgbImage& mean;     // of each piece, before the base image; empty pieces filled
  const Plane& refused;     // 1 where a piece kept its own mean; empty: no piece could choose
  const CountImage& n;      // samples of each piece
  const CountImage& level;  // [y][x]
  const FilterWidths<T>& widths;
  const DirectionalOptions& options;
  int pieces_per_side;
};

// Adds the footprint of every pixel that `footprints` names. In plain double loops: the weights are
// those of anisotropic_filter.h to the precision of T.
template <class T>
void tell_footprints(const FootprintInput<T>& input, Footprints& footprints);

}  // namespace spool
