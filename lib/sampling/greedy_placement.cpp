#include "lib/sampling/greedy_placement.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/parallel_sort.h"
#include "lib/core/random.h"
#include "lib/core/total_order.h"
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

// Offsets of Chebyshev radius 1, 2, .. reach; inside a ring the smallest Euclidean distance first,
// then the lowest index.
using Rings = std::vector<std::vector<std::array<int, 3>>>;  // squared distance, dy, dx

Rings rings_within(int reach) {
  Rings rings(static_cast<std::size_t>(reach));
  for (int radius = 1; radius <= reach; ++radius) {
    auto& ring = rings[static_cast<std::size_t>(radius - 1)];
    for (int dy = -radius; dy <= radius; ++dy) {
      const bool edge = std::abs(dy) == radius;
      for (int dx = -radius; dx <= radius; dx += edge ? 1 : 2 * radius)
        ring.push_back({dx * dx + dy * dy, dy, dx});
    }
    std::sort(ring.begin(), ring.end());
  }
  return rings;
}

// The nearest pixel that can give a sample.
bool give_nearby(Offer& offer, int x, int y, const Rings& rings, const Rectangle& bounds) {
  for (const auto& ring : rings) {
    for (const auto& [distance, dy, dx] : ring) {
      if (bounds.contains(x + dx, y + dy) && offer.give(x + dx, y + dy)) return true;
    }
  }
  return false;
}

// A pixel drawn for a sample, and how many draws were made.
struct Target {
  int x = 0, y = 0;
  std::uint64_t draws = 0;
};

// A sample for pixel (x, y) is drawn from the kernel of its scale.
struct Wish {
  const OffsetDraw* draw = nullptr;
  const Rings* rings = nullptr;
  int x = 0, y = 0;
  std::uint64_t seed = 0;
  Target first;  // to be tried

  Target target(std::uint64_t draws, const Rectangle& bounds) const {
    while (true) {  // ends: the pixel itself is inside and has the largest tap
      const int tx = x + (*draw)(mix(seed, draws, 0)), ty = y + (*draw)(mix(seed, draws, 1));
      ++draws;
      if (bounds.contains(tx, ty)) return {tx, ty, draws};
    }
  }
};

// False when the sample could not be placed.
bool place_sample(Offer& offer, const Wish& wish, const Rectangle& bounds) {
  Target target = wish.first;
  for (int attempt = 0; attempt <= kRedraws; ++attempt) {
    if (attempt > 0) target = wish.target(target.draws, bounds);
    if (offer.give(target.x, target.y)) return true;
  }
  return offer.give(wish.x, wish.y) || give_nearby(offer, wish.x, wish.y, *wish.rings, bounds);
}

// The `wanted` pixels of largest error, the largest first, of equal ones the first of the image.
std::vector<std::size_t> largest_first(const Plane& error, long long wanted) {
  if (wanted == 0) return {};
  std::vector<double> ranked(error.pixels().begin(), error.pixels().end());
  const auto cut = ranked.begin() + (wanted - 1);
  std::nth_element(ranked.begin(), cut, ranked.end(), descending);
  const double smallest = *cut;
  auto equal = wanted - std::count_if(ranked.begin(), cut,
                                      [&](double value) { return descending(value, smallest); });
  std::vector<std::size_t> order;
  order.reserve(static_cast<std::size_t>(wanted));
  for (std::size_t p = 0; p < error.size(); ++p) {
    if (descending(error[p], smallest) || (!descending(smallest, error[p]) && equal-- > 0))
      order.push_back(p);
  }
  parallel_sort(order, [&](std::size_t a, std::size_t b) {
    return descending(error[a], error[b]) || (!descending(error[b], error[a]) && a < b);
  });
  return order;
}

}  // namespace

CountImage hand_out_greedily(const GreedyErrorMap& map, const PieceStatistics& statistics,
                             const SamplePool& pool, long long share, long long per_pixel,
                             std::uint64_t seed, const GreedyErrorOptions& options) {
  const Rectangle bounds = map.error.bounds();
  const bool subpixel = uses_cells(options.grid, pool);
  std::vector<OffsetDraw> draws;
  std::vector<Rings> rings;
  for (int s = 0; s <= options.scales; ++s) {
    const double sigma = s == 0 ? 0.0 : greedy_sampling_scale(s);
    const Taps gaussian = s == 0 ? Taps{0, {1.0}} : floor_gaussian_taps(sigma);
    draws.emplace_back(compose_with_base(gaussian, subpixel).taps);
    rings.push_back(rings_within(std::max(1, static_cast<int>(3.0 * sigma))));
  }
  const auto wanted = std::min<long long>((share + per_pixel - 1) / per_pixel,
                                          static_cast<long long>(map.error.size()));
  const std::vector<std::size_t> order = largest_first(map.error, wanted);

  const auto wish_of = [&](long long i) {
    const std::size_t p = order[static_cast<std::size_t>(i / per_pixel)];
    const auto scale = static_cast<std::size_t>(map.scale[p]);
    Wish wish{.draw = &draws[scale],
              .rings = &rings[scale],
              .x = static_cast<int>(p) % bounds.x1,
              .y = static_cast<int>(p) / bounds.x1,
              .seed = mix(seed, p, i % per_pixel),
              .first = {}};
    wish.first = wish.target(0, bounds);
    return wish;
  };
  // What pixels have left depends on the order in which samples are placed; where each is tried
  // first does not.
  constexpr long long kTogether = 1 << 14;
  Offer offer(pool, statistics.n);
  const long long count = std::min(share, wanted * per_pixel);
  long long pot = share - count;
  std::vector<Wish> wishes;
  for (long long begin = 0; begin < count; begin += kTogether) {
    wishes.resize(static_cast<std::size_t>(std::min(kTogether, count - begin)));
    parallel_for(wishes.size(),
                 [&](std::size_t i) { wishes[i] = wish_of(begin + static_cast<long long>(i)); });
    for (const Wish& wish : wishes) {
      if (!place_sample(offer, wish, bounds)) ++pot;
    }
  }
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
