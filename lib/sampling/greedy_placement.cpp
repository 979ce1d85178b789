#include "lib/sampling/greedy_placement.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <vector>

#include "lib/core/random.h"
#include "lib/kernels/pixel_base.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/sampling/filter_disagreement.h"
#include "lib/sampling/rounds.h"

namespace spool {
namespace {

constexpr int kRedraws = 16;

// Draws whole offsets with the probabilities of a kernel's taps.
class OffsetDraw {
 public:
  explicit OffsetDraw(const Taps& taps) : first_(taps.first) {
    double sum = 0.0;
    for (const double tap : taps.values)
      cumulative_.push_back(sum += std::max(tap, 0.0));
  }
  int operator()(std::uint64_t bits) const {
    const double at = unit_double(bits) * cumulative_.back();
    const auto it = std::upper_bound(cumulative_.begin(), cumulative_.end(), at);
    const auto i = std::min<std::ptrdiff_t>(it - cumulative_.begin(),
                                            static_cast<std::ptrdiff_t>(cumulative_.size()) - 1);
    return first_ + static_cast<int>(i);
  }

 private:
  int first_;
  std::vector<double> cumulative_;
};

// Counts that grow while an iteration hands its samples out; a pixel offers what its pieces have.
class Offer {
 public:
  Offer(const SamplePool& pool, const CountImage& n)
      : pool_(pool), extra_(n.width(), n.height()), n_(n) {}

  // Gives a sample to the least-sampled unsaturated piece of a pixel; false when it has none.
  bool give(int x, int y) {
    const int q = pool_.pieces_per_side();
    std::optional<std::size_t> best;
    for (int py = y * q; py < (y + 1) * q; ++py) {
      for (int px = x * q; px < (x + 1) * q; ++px) {
        const std::size_t i = n_.index(px, py);
        if (n_[i] + extra_[i] >= pool_.capacity(px, py)) continue;
        if (!best || n_[i] + extra_[i] < n_[*best] + extra_[*best]) best = i;
      }
    }
    if (best) ++extra_[*best];
    return best.has_value();
  }
  CountImage& extra() { return extra_; }

 private:
  const SamplePool& pool_;
  CountImage extra_;
  const CountImage& n_;
};

// The nearest pixel within `reach` that can give a sample: rings of growing Chebyshev radius,
// inside a ring the smallest Euclidean distance, then the lowest index.
bool give_nearby(Offer& offer, int x, int y, int reach, const Rectangle& bounds) {
  for (int radius = 1; radius <= reach; ++radius) {
    std::vector<std::array<int, 3>> ring;  // squared distance, y, x
    for (int dy = -radius; dy <= radius; ++dy) {
      const bool edge = std::abs(dy) == radius;
      for (int dx = -radius; dx <= radius; dx += edge ? 1 : 2 * radius) {
        if (bounds.contains(x + dx, y + dy)) ring.push_back({dx * dx + dy * dy, y + dy, x + dx});
      }
    }
    std::sort(ring.begin(), ring.end());
    for (const auto& [distance, py, px] : ring) {
      if (offer.give(px, py)) return true;
    }
  }
  return false;
}

// One sample for pixel (x, y), drawn from the kernel of its scale; false when none could be placed.
bool place_sample(Offer& offer, const OffsetDraw& draw, int x, int y, int reach,
                  const Rectangle& bounds, std::uint64_t seed) {
  std::uint64_t counter = 0;
  const auto target = [&] {
    while (true) {  // ends: the pixel itself is inside and has the largest tap
      const int tx = x + draw(mix(seed, counter, 0)), ty = y + draw(mix(seed, counter, 1));
      ++counter;
      if (bounds.contains(tx, ty)) return std::array<int, 2>{tx, ty};
    }
  };
  for (int attempt = 0; attempt <= kRedraws; ++attempt) {
    const auto [tx, ty] = target();
    if (offer.give(tx, ty)) return true;
  }
  return offer.give(x, y) || give_nearby(offer, x, y, reach, bounds);
}

}  // namespace

CountImage hand_out_greedily(const GreedyErrorMap& map, const PieceStatistics& statistics,
                             const SamplePool& pool, long long share, long long per_pixel,
                             std::uint64_t seed, const GreedyErrorOptions& options) {
  const Rectangle bounds = map.error.bounds();
  const bool subpixel = options.grid != GreedyGrid::kPixel && pool.recording().has_film();
  std::vector<OffsetDraw> draws;
  std::vector<int> reach;
  for (int s = 0; s <= options.scales; ++s) {
    const double sigma = s == 0 ? 0.0 : greedy_sampling_scale(s);
    const Taps gaussian = s == 0 ? Taps{0, {1.0}} : floor_gaussian_taps(sigma);
    draws.emplace_back(compose_with_base(gaussian, subpixel).taps);
    reach.push_back(std::max(1, static_cast<int>(3.0 * sigma)));
  }
  std::vector<std::size_t> order(map.error.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto wanted = std::min<long long>((share + per_pixel - 1) / per_pixel,
                                          static_cast<long long>(order.size()));
  const auto larger = [&](std::size_t a, std::size_t b) {
    return map.error[a] != map.error[b] ? map.error[a] > map.error[b] : a < b;
  };
  std::nth_element(order.begin(), order.begin() + (wanted - 1), order.end(), larger);
  std::sort(order.begin(), order.begin() + wanted, larger);

  Offer offer(pool, statistics.n);
  long long left = share, pot = 0;
  for (long long i = 0; i < wanted; ++i) {
    const std::size_t p = order[static_cast<std::size_t>(i)];
    const int x = static_cast<int>(p) % bounds.x1, y = static_cast<int>(p) / bounds.x1;
    const auto scale = static_cast<std::size_t>(map.scale[p]);
    for (long long j = 0; j < per_pixel && left > 0; ++j, --left) {
      if (!place_sample(offer, draws[scale], x, y, reach[scale], bounds, mix(seed, p, j))) ++pot;
    }
  }
  pot += left;
  CountImage& extra = offer.extra();
  if (pot > 0) {
    CountImage n = statistics.n;
    for (std::size_t i = 0; i < n.size(); ++i)
      n[i] += extra[i];
    const CountImage more =
        hand_out(pixels_to_pieces(map.error, pool.pieces_per_side()), n, pool, pot);
    for (std::size_t i = 0; i < n.size(); ++i)
      extra[i] += more[i];
  }
  return extra;
}

}  // namespace spool
