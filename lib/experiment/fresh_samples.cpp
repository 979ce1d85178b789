#include "lib/experiment/fresh_samples.h"

#include <algorithm>
#include <utility>

#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

double saturated_share(const SamplePool& pool, const CountImage& n) {
  double saturated = 0.0;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      saturated += n(x, y) >= pool.capacity(x, y) ? 1.0 : 0.0;
  }
  return saturated / static_cast<double>(n.size());
}

}  // namespace

Selection with_samples_of(const SamplePool& pool, const Selection& decided) {
  CountImage n = decided.statistics.n;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      n(x, y) = std::min(n(x, y), pool.capacity(x, y));
  }
  Selection fresh{prefix_statistics(pool, n, decided.statistics.signal,
                                    decided.statistics.channel_minimum.has_value()),
                  decided.attenuation};
  for (std::size_t h = 0; h < decided.halves.size(); ++h)
    fresh.halves.push_back(with_samples_of(pool.half(static_cast<int>(h)), decided.halves[h]));
  if (decided.halves_use == HalvesUse::kTogether) return join_halves(pool, std::move(fresh.halves));
  return fresh;
}

Result<std::optional<HalfSelections>> select_halves(const SamplePool& pool, long long budget,
                                                    const SelectHalf& sample) {
  const std::array<SamplePool, 2> half = {pool.half(0), pool.half(1)};
  if (std::min(half[0].total_capacity(), half[1].total_capacity()) < budget) return std::nullopt;
  HalfSelections selections;
  for (std::size_t h = 0; h < 2; ++h) {
    SPOOL_ASSIGN(selections.own[h], sample(half[h], h));
    selections.fresh[1 - h] = with_samples_of(half[1 - h], selections.own[h]);
    selections.saturated_share += 0.5 * saturated_share(half[h], selections.own[h].statistics.n);
  }
  return selections;
}

CountImage looked_at(const SamplePool& pool, const HalfSelections& halves) {
  CountImage n(pool.width(), pool.height());
  for (const auto* selections : {&halves.own, &halves.fresh}) {
    for (int h = 0; h < 2; ++h) {
      const CountImage taken = looked_at((*selections)[static_cast<std::size_t>(h)]);
      for (std::size_t i = 0; i < n.size(); ++i) {
        // Sample j of half h is sample 2 j + h of the pool.
        if (taken[i] > 0) n[i] = std::max(n[i], 2 * (taken[i] - 1) + h + 1);
      }
    }
  }
  return n;
}

Result<FreshErrors> judge_halves(const SamplePool& pool, const HalfSelections& halves,
                                 const JudgingReference& reference, const MetricOptions& options,
                                 const FilterHalf& filter) {
  MetricOptions plain = options;
  plain.perceptual = Perceptual::kNone;
  plain.bootstrap.resamples = 0;
  FreshErrors errors;
  std::array<RgbImage, 2> own;
  double relative_scale = 1.0;
  for (std::size_t h = 0; h < 2; ++h) {
    const SamplePool half = pool.half(static_cast<int>(h));
    SPOOL_ASSIGN(const RgbImage fresh, filter(halves.fresh[h], half));
    const MetricTable table = error_metrics(fresh, reference, plain);
    errors.mse += 0.5 * table["mse"].value;
    errors.relmse += 0.5 * table["relmse"].value;
    errors.energy_ratio += 0.5 * table["energy_ratio"].value;
    relative_scale = table.relative_scale;
    SPOOL_ASSIGN(own[h], filter(halves.own[h], half));
  }
  errors.parts = error_parts(own[0], own[1], reference, relative_scale, options);
  errors.saturated_share = halves.saturated_share;
  return errors;
}

FreshErrors mean_of(const std::vector<FreshErrors>& errors) {
  FreshErrors mean;
  const double share = 1.0 / static_cast<double>(errors.size());
  for (const FreshErrors& e : errors) {
    mean.mse += share * e.mse;
    mean.relmse += share * e.relmse;
    mean.energy_ratio += share * e.energy_ratio;
    mean.parts.bias2 += share * e.parts.bias2;
    mean.parts.variance += share * e.parts.variance;
    mean.parts.relative_bias2 += share * e.parts.relative_bias2;
    mean.parts.relative_variance += share * e.parts.relative_variance;
    mean.parts.pixels += e.parts.pixels;
    mean.saturated_share += share * e.saturated_share;
  }
  return mean;
}

}  // namespace spool
