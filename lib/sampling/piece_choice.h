// Which pieces of a region are sampled, when not all can be.
#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

namespace spool {

// A piece of the grid that still has samples to offer.
struct OpenPiece {
  int n = 0;  // samples it has
  int x = 0, y = 0;
};

// Keeps those that get one sample each when `left` are left: all, or the first by (n, y, x).
inline void keep_first(std::vector<OpenPiece>& pieces, long long left) {
  if (static_cast<long long>(pieces.size()) <= left) return;
  std::ranges::sort(pieces, {},
                    [](const OpenPiece& piece) { return std::tie(piece.n, piece.y, piece.x); });
  pieces.resize(static_cast<std::size_t>(left));
}

}  // namespace spool
