#include "lib/sampling/piece_choice.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "lib/core/random.h"

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

std::vector<PieceShare> to_least_sampled(const std::vector<OpenPiece>& pieces,
                                         const SamplePool& pool, long long wanted,
                                         std::uint64_t seed) {
  using Candidate = std::tuple<int, std::uint64_t, std::size_t>;  // samples, tie, which
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> waiting;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    waiting.emplace(pieces[i].n, mix(seed, pieces[i].x, pieces[i].y), i);
  std::vector<int> given(pieces.size(), 0);
  for (long long chosen = 0; chosen < wanted && !waiting.empty(); ++chosen) {
    const auto [n, tie, i] = waiting.top();
    waiting.pop();
    ++given[i];
    if (n + 1 < pool.capacity(pieces[i].x, pieces[i].y)) waiting.emplace(n + 1, tie, i);
  }
  std::vector<PieceShare> shares;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (given[i] > 0) shares.push_back({pieces[i].x, pieces[i].y, given[i]});
  }
  return shares;
}

}  // namespace spool
