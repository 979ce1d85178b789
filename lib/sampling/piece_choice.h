// Which pieces of a region are sampled, when not all can be.
#pragma once

#include <vector>

namespace spool {

// A piece of the grid that still has samples to offer.
struct OpenPiece {
  int n = 0;  // samples it has
  int x = 0, y = 0;
};

struct PieceShare {
  int x = 0, y = 0;
  int count = 0;
};

// One sample each, for the first in the order (n, y, x) when fewer than that are left.
std::vector<PieceShare> one_each(std::vector<OpenPiece> pieces, long long left);

}  // namespace spool
