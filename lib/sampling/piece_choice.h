// Which pieces of a region are sampled, when not all can be.
#pragma once

#include <vector>

namespace spool {

// A piece of the grid that still has samples to offer.
struct OpenPiece {
  int n = 0;  // samples it has
  int x = 0, y = 0;
};

// Keeps those that get one sample each when `left` are left: all, or the first in the order
// (n, y, x).
void keep_first(std::vector<OpenPiece>& pieces, long long left);

}  // namespace spool
