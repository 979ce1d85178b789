#include "lib/sampling/apportion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lib/core/check.h"
#include "lib/core/parallel_count.h"

namespace spool {
namespace {

// Weights as whole multiples of 2^-32 of the largest.
std::vector<std::uint64_t> fractions_of_largest(std::span<const double> weights) {
  std::vector<double> largest_of((weights.size() + kStretch - 1) / kStretch, 0.0);
  parallel_stretches(weights.size(), [&](std::size_t begin, std::size_t end) {
    double& largest = largest_of[begin / kStretch];
    for (const double w : weights.subspan(begin, end - begin)) {
      if (std::isfinite(w)) largest = std::max(largest, w);
    }
  });
  double largest = 0.0;
  for (const double w : largest_of)
    largest = std::max(largest, w);
  const bool any_infinite = std::any_of(weights.begin(), weights.end(),
                                        [](double w) { return std::isinf(w) && w > 0.0; });
  if (largest == 0.0 && any_infinite) largest = 1.0;  // only the infinite ones count
  std::vector<std::uint64_t> units(weights.size(), 0);
  if (largest == 0.0) return units;
  parallel_stretches(units.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (!std::isgreater(weights[t], 0.0)) continue;  // nor NaN
      units[t] = static_cast<std::uint64_t>(std::min(weights[t] / largest, 1.0) * 0x1.0p32);
    }
  });
  return units;
}

// Wide: unsigned, for products of a budget and a weight, and for the sum of weights.
template <class Wide>
std::vector<long long> apportion_units(const std::vector<std::uint64_t>& units, long long budget,
                                       std::span<const long long> caps) {
  std::vector<long long> share(units.size(), 0);
  std::vector<std::size_t> active;
  long long capacity = 0;
  for (std::size_t t = 0; t < caps.size(); ++t) {
    SPOOL_CHECK_GE(caps[t], 0);
    capacity += caps[t];
    if (caps[t] > 0) active.push_back(t);
  }
  long long left = std::min(budget, capacity);
  while (left > 0) {
    auto total =
        parallel_count<Wide>(active.size(), [&](std::size_t i) { return Wide{units[active[i]]}; });
    const bool equal = total == 0;
    if (equal) total = active.size();
    const long long divided = left;
    const auto product = [&](std::size_t t) {
      return static_cast<Wide>(divided) * (equal ? 1 : units[t]);
    };
    const auto filled = parallel_count<long long>(active.size(), [&](std::size_t i) {
      const std::size_t t = active[i];
      if (product(t) / total < static_cast<Wide>(caps[t])) return 0LL;
      return share[t] = caps[t];
    });
    left -= filled;
    if (filled > 0) {  // what they cannot take makes the quotas of the others larger
      std::erase_if(active, [&](std::size_t t) { return share[t] == caps[t]; });
      continue;
    }
    left -= parallel_count<long long>(active.size(), [&](std::size_t i) {
      const std::size_t t = active[i];
      return share[t] = static_cast<long long>(product(t) / total);
    });
    std::vector<std::pair<Wide, std::size_t>> remainders;
    remainders.reserve(active.size());
    for (const std::size_t t : active)
      remainders.emplace_back(product(t) % total, t);
    const auto larger = [](const auto& x, const auto& y) {
      return x.first != y.first ? x.first > y.first : x.second < y.second;
    };
    SPOOL_CHECK_LE(static_cast<std::size_t>(left), remainders.size());
    const auto cut = remainders.begin() + left;
    std::nth_element(remainders.begin(), cut, remainders.end(), larger);
    for (auto it = remainders.begin(); it != cut; ++it)
      ++share[it->second];
    break;
  }
  return share;
}

}  // namespace

std::vector<long long> apportion(std::span<const double> weights, long long budget,
                                 std::span<const long long> caps) {
  SPOOL_CHECK_EQ(weights.size(), caps.size());
  SPOOL_CHECK_GE(budget, 0);
  const std::vector<std::uint64_t> units = fractions_of_largest(weights);
  // Weights are at most 2^32; dividing 128 bits takes several times as long.
  constexpr long long kMost = 1LL << 31;
  if (budget <= kMost && static_cast<long long>(units.size()) <= kMost)
    return apportion_units<std::uint64_t>(units, budget, caps);
  return apportion_units<unsigned __int128>(units, budget, caps);
}

}  // namespace spool
