#include "lib/experiment/fresh_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lib/core/pairwise_sum.h"

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

FreshErrors fresh_errors(const std::array<RgbImage, 2>& fresh, const std::array<RgbImage, 2>& own,
                         const JudgingReference& reference, const MetricOptions& options) {
  MetricOptions plain = options;
  plain.perceptual = Perceptual::kNone;
  plain.bootstrap.resamples = 0;
  plain.support = false;
  plain.wanted.assign(metrics().size(), false);
  for (const char* name : {"mse", "relmse", "energy_ratio"})
    plain.wanted[static_cast<std::size_t>(metric_index(name))] = true;
  FreshErrors errors;
  double relative_scale = 1.0;
  for (const RgbImage& image : fresh) {
    const MetricTable table = error_metrics(image, reference, plain);
    errors.mse += 0.5 * table["mse"].value;
    errors.relmse += 0.5 * table["relmse"].value;
    errors.energy_ratio += 0.5 * table["energy_ratio"].value;
    relative_scale = table.relative_scale;
  }
  errors.parts = error_parts(own[0], own[1], reference, relative_scale, options);
  return errors;
}

// The side of a cell: eight along the longer side of the image, of 8 pixels at least.
int cell_side(const Plane& image) {
  return std::max(8, (std::max(image.width(), image.height()) + 7) / 8);
}

double mean_of_map(const Plane& map) {
  return pairwise_sum(map.size(), [&](std::size_t p) { return map[p]; });
}

// Samples that a replicate took of the pixel's pieces, as of a list of a whole pixel, in sixteen
// steps of the recording's.
int taken_at(const CountImage& taken, const Plane& map, int x, int y, int recorded) {
  const int q = taken.width() / map.width();
  int most = 0;
  for (int j = 0; j < q; ++j) {
    for (int i = 0; i < q; ++i)
      most = std::max(most, taken(x * q + i, y * q + j) * q * q);
  }
  const int step = std::max(1, recorded / 16);
  return std::min(recorded, (most + step - 1) / step * step);
}

HalfDifference half_difference(const Plane& a, const Plane& b, const CountImage& taken,
                               int recorded) {
  HalfDifference found;
  const int side = cell_side(a);
  const double mean = 0.5 * (mean_of_map(a) + mean_of_map(b));
  if (!(mean > 0.0)) return found;
  found.columns = (a.width() + side - 1) / side;
  found.cells.resize(static_cast<std::size_t>(found.columns) *
                     static_cast<std::size_t>((a.height() + side - 1) / side));
  std::map<int, double> squares;
  double all = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      const double difference = (a(x, y) - b(x, y)) / mean;
      found.cells[static_cast<std::size_t>(y / side * found.columns + x / side)] += difference;
      squares[taken_at(taken, a, x, y, recorded)] += difference * difference;
      all += difference * difference;
    }
  }
  for (const auto& [samples, square] : squares) {
    const double share = all > 0.0 ? square / all : 0.0;
    if (share >= 5e-7) found.varying.emplace_back(samples, std::llround(1e6 * share));
  }
  return found;
}

void add_differences(const std::array<RgbImage, 2>& images, const CountImage& taken,
                     const JudgingReference& reference, const MetricOptions& options,
                     const char* suffix, HalfErrors& errors, int recorded) {
  const std::vector<ErrorMap> a = error_maps(images[0], reference, options);
  const std::vector<ErrorMap> b = error_maps(images[1], reference, options);
  for (std::size_t m = 0; m < std::min(a.size(), b.size()); ++m) {
    HalfDifference difference = half_difference(a[m].parts, b[m].parts, taken, recorded);
    if (difference.cells.empty()) continue;
    errors.differences.push_back({a[m].metric + suffix, std::move(difference)});
  }
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
                                                    bool fresh, const SelectHalf& sample) {
  const std::array<SamplePool, 2> half = {pool.half(0), pool.half(1)};
  if (std::min(half[0].total_capacity(), half[1].total_capacity()) < budget) return std::nullopt;
  HalfSelections selections;
  if (fresh) selections.fresh.emplace();
  for (std::size_t h = 0; h < 2; ++h) {
    SPOOL_ASSIGN(selections.own[h], sample(half[h], h));
    if (fresh) (*selections.fresh)[1 - h] = with_samples_of(half[1 - h], selections.own[h]);
    selections.saturated_share += 0.5 * saturated_share(half[h], selections.own[h].statistics.n);
  }
  return selections;
}

CountImage looked_at(const SamplePool& pool, const HalfSelections& halves) {
  CountImage n(pool.width(), pool.height());
  for (const auto* selections : {&halves.own, halves.fresh ? &*halves.fresh : nullptr}) {
    if (!selections) continue;
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

Result<HalfErrors> judge_halves(const SamplePool& pool, const HalfSelections& halves,
                                const CountImage& taken, const JudgingReference& reference,
                                const MetricOptions& options, const FilterHalf& filter) {
  const std::array<SamplePool, 2> half = {pool.half(0), pool.half(1)};
  HalfErrors errors;
  std::array<RgbImage, 2> own, fresh;
  for (std::size_t h = 0; h < 2; ++h) {
    SPOOL_ASSIGN(own[h], filter(halves.own[h], half[h]));
  }
  add_differences(own, taken, reference, options, "", errors, pool.recording().spp());
  if (!halves.fresh) return errors;
  for (std::size_t h = 0; h < 2; ++h) {
    SPOOL_ASSIGN(fresh[h], filter((*halves.fresh)[h], half[h]));
  }
  errors.fresh = fresh_errors(fresh, own, reference, options);
  errors.fresh->saturated_share = halves.saturated_share;
  MetricOptions plain = options;
  plain.perceptual = Perceptual::kNone;
  add_differences(fresh, taken, reference, plain, "_fresh", errors, pool.recording().spp());
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
