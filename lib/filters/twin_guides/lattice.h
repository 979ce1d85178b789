// Every step-th piece of an image, from one of its first pieces on.
//
// A window whose taps stand `step` apart is a plain window on a lattice, and step^2 lattices side
// by side are the image: a coarse scale is the fine one's work on each of them.
#pragma once

#include "lib/core/rectangle.h"

namespace spool {

struct Lattice {
  int step, left, top;  // piece (left, top) of the image is (0, 0) of the lattice
  int width, height;    // pieces of the lattice; 0 where the image is smaller than the step

  Rectangle bounds() const { return {0, 0, width, height}; }
  int column(int x) const { return left + step * x; }  // in the image
  int row(int y) const { return top + step * y; }
};

// number: 0 .. step^2 - 1.
inline Lattice lattice_of(int width, int height, int step, int number) {
  const int left = number % step, top = number / step;
  return {step, left, top, (width - left + step - 1) / step, (height - top + step - 1) / step};
}

}  // namespace spool
