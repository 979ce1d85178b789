#include "lib/sampling/piece_choice.h"

#include <algorithm>
#include <tuple>

namespace spool {

std::vector<PieceShare> one_each(std::vector<OpenPiece> pieces, long long left) {
  if (static_cast<long long>(pieces.size()) > left) {
    std::sort(pieces.begin(), pieces.end(), [](const OpenPiece& a, const OpenPiece& b) {
      return std::tie(a.n, a.y, a.x) < std::tie(b.n, b.y, b.x);
    });
    pieces.resize(static_cast<std::size_t>(left));
  }
  std::vector<PieceShare> shares;
  shares.reserve(pieces.size());
  for (const OpenPiece& piece : pieces)
    shares.push_back({piece.x, piece.y, 1});
  return shares;
}

}  // namespace spool
