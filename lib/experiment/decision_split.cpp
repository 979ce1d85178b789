#include "lib/experiment/decision_split.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lib/sampling/spending.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

CountImage at_most_capacity(CountImage n, const SamplePool& pool) {
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      n(x, y) = std::min(n(x, y), pool.capacity(x, y));
  }
  return n;
}

void add(SamplingLog& log, const SamplingLog& part) {
  log.initial += part.initial;
  log.uniform_remainder += part.uniform_remainder;
  log.guards += part.guards;
  log.samples_of_level.resize(std::max(log.samples_of_level.size(), part.samples_of_level.size()));
  for (std::size_t k = 0; k < part.samples_of_level.size(); ++k)
    log.samples_of_level[k] += part.samples_of_level[k];
}

Result<SamplingResult> sample_halves(const SamplerFunction& sampler, const SamplePool& pool,
                                     long long budget, const SamplingContext& context) {
  const std::array<SamplePool, 2> halves = {pool.half(0), pool.half(1)};
  SamplingResult result;
  result.log.budget = budget;
  result.selection.halves.resize(2);
  std::array<CountImage, 2> looked;
  for (std::size_t h = 0; h < 2; ++h) {
    SamplingContext part = context;
    part.seed = mix(context.seed, h);
    if (h == 1) part.views = nullptr;  // they are those of the even samples
    if (context.progress) {
      part.progress = [&](double share) {
        context.progress(0.5 * (static_cast<double>(h) + share));
      };
    }
    SPOOL_ASSIGN(SamplingResult decided,
                 sampler(halves[h], (budget + 1 - static_cast<long long>(h)) / 2, part));
    add(result.log, decided.log);
    const std::size_t other = 1 - h;
    Selection& averaged = result.selection.halves[other];
    averaged.statistics = prefix_statistics(
        halves[other], at_most_capacity(decided.selection.statistics.n, halves[other]),
        decided.selection.statistics.signal);
    averaged.attenuation = std::move(decided.selection.attenuation);
    looked[h] = looked_at(decided.selection);
  }
  for (std::size_t h = 0; h < 2; ++h) {
    const CountImage& averaged = result.selection.halves[h].statistics.n;
    for (std::size_t i = 0; i < averaged.size(); ++i)
      looked[h][i] = std::max(looked[h][i], averaged[i]);
  }
  result.selection.statistics = prefix_statistics(pool, prefixes_over(looked[0], looked[1]),
                                                  result.selection.halves[0].statistics.signal);
  result.log.spent = count_samples(result.selection.statistics.n);
  // Guards of the halves have counted what ran out there; here it is said of the whole pool.
  result.log.saturated_pieces = count_saturated(pool, result.selection.statistics.n);
  return result;
}

RgbImage weighted_sum(RgbImage a, const RgbImage& b, double weight) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < a[c].size(); ++i)
      a[c][i] = weight * (a[c][i] + b[c][i]);
  }
  return a;
}

Result<Reconstruction> filter_halves(const FilterFunction& filter, const Selection& selection,
                                     const SamplePool& pool, const FilterContext& context) {
  FilterContext of_odd = context;
  of_odd.views = nullptr;
  Footprints odd_footprints(wanted_pixels(context));
  if (context.footprints) of_odd.footprints = &odd_footprints;
  SPOOL_ASSIGN(Reconstruction result, filter(selection.halves[0], pool.half(0), context));
  SPOOL_ASSIGN(const Reconstruction odd, filter(selection.halves[1], pool.half(1), of_odd));
  result.image = weighted_sum(std::move(result.image), odd.image, 0.5);
  if (context.footprints) context.footprints->average_with(odd_footprints);
  if (result.variance && odd.variance) {
    result.variance = weighted_sum(std::move(*result.variance), *odd.variance, 0.25);
  }
  result.guards += odd.guards;
  return result;
}

}  // namespace

ReadySampler split_decisions(ReadySampler sampler) {
  return {[run = std::move(sampler.run)](const SamplePool& pool, long long budget,
                                         const SamplingContext& context) {
            return sample_halves(run, pool, budget, context);
          },
          sampler.needs};
}

ReadyFilter average_halves(ReadyFilter filter) {
  return {[run = std::move(filter.run)](const Selection& selection, const SamplePool& pool,
                                        const FilterContext& context) {
            if (selection.halves.empty()) return run(selection, pool, context);
            if (selection.halves_use == HalvesUse::kTogether) {
              return run(selection, pool_of_joined(pool, selection), context);
            }
            return filter_halves(run, selection, pool, context);
          },
          filter.needs};
}

}  // namespace spool
