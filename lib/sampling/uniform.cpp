#include "lib/sampling/uniform.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/sampling/spending.h"

namespace spool {

CountImage raise_least_sampled(const CountImage& n, const SamplePool& pool, const Rectangle& area,
                               long long budget, std::uint64_t seed, int limit) {
  SPOOL_CHECK_EQ(n.width(), pool.width());
  SPOOL_CHECK_EQ(n.height(), pool.height());
  SPOOL_CHECK_GE(budget, 0);
  const auto for_each_piece = [&](auto&& body) {  // body(x, y, n, most it may have)
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x)
        body(x, y, n(x, y), std::max(n(x, y), std::min(pool.capacity(x, y), limit)));
    }
  };
  int highest = 0;
  for_each_piece([&](int, int, int, int most) { highest = std::max(highest, most); });
  // takers[l]: pieces that take a sample when the level rises from l to l + 1.
  std::vector<long long> takers(static_cast<std::size_t>(highest) + 1, 0);
  for_each_piece([&](int, int, int has, int most) {
    ++takers[static_cast<std::size_t>(has)];
    --takers[static_cast<std::size_t>(most)];
  });
  for (std::size_t l = 1; l < takers.size(); ++l)
    takers[l] += takers[l - 1];

  int level = 0;
  long long left = budget;
  while (level < highest && takers[static_cast<std::size_t>(level)] <= left) {
    left -= takers[static_cast<std::size_t>(level)];
    ++level;
  }
  CountImage raised(area.width(), area.height());
  std::vector<std::pair<std::uint64_t, std::size_t>> last_takers;  // at the level left incomplete
  for_each_piece([&](int x, int y, int has, int most) {
    const std::size_t i = raised.index(x - area.x0, y - area.y0);
    raised[i] = std::max(has, std::min(level, most));
    if (raised[i] == level && level < most) last_takers.emplace_back(mix(seed, n.index(x, y)), i);
  });
  if (level == highest) return raised;
  SPOOL_CHECK_LT(left, static_cast<long long>(last_takers.size()));
  std::nth_element(last_takers.begin(), last_takers.begin() + left, last_takers.end());
  for (auto it = last_takers.begin(); it != last_takers.begin() + left; ++it)
    ++raised[it->second];
  return raised;
}

Result<SamplingResult> sample_uniform(const SamplePool& pool, long long budget,
                                      const UniformOptions&, const SamplingContext& context) {
  const CountImage none(pool.width(), pool.height());
  return end_spending(
      begin_spending(pool, budget,
                     raise_least_sampled(none, pool, none.bounds(), budget, context.seed)),
      pool);
}

Sampler uniform_sampler() {
  return make_value<SamplerFunction, UniformOptions>(
      {.name = "uniform",
       .summary = "the same number of samples in every piece",
       .memory = {128, 2e6},
       .cost = 0.125,
       .run = sample_uniform});
}

}  // namespace spool
