#include "lib/sampling/piece_choice.h"

#include <algorithm>
#include <tuple>

namespace spool {

void keep_first(std::vector<OpenPiece>& pieces, long long left) {
  if (static_cast<long long>(pieces.size()) <= left) return;
  std::sort(pieces.begin(), pieces.end(), [](const OpenPiece& a, const OpenPiece& b) {
    return std::tie(a.n, a.y, a.x) < std::tie(b.n, b.y, b.x);
  });
  pieces.resize(static_cast<std::size_t>(left));
}

}  // namespace spool
