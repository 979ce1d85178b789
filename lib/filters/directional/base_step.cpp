#include "lib/filters/directional/base_step.h"

#include <vector>

#include "lib/core/parallel.h"
#include "lib/filters/directional/base_image.h"
#include "lib/filters/directional/filter_size.h"
#include "lib/filters/directional/size_factor.h"
#include "lib/filters/directional/stop_votes.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/region_mean.h"

namespace spool {
namespace {

// The signals that eq 9 looks at.
struct Signal {
  const Plane& mean;
  const Plane& variance;
};

std::vector<Signal> deciding_signals(const Tile& tile) {
  if (tile.channels.empty()) return {{tile.analysis.mean, tile.analysis.variance}};
  std::vector<Signal> signals;
  for (const SizeChannel& channel : tile.channels)
    signals.push_back({channel.mean, channel.variance});
  return signals;
}

// The base image of a piece beside a lamp holds two or three pieces of it, too few for evidence
// where few samples found it: R_2 holds more. Of so many regions one is often 3 deviations away.
constexpr int kWideLevel = 2;
constexpr double kWideEvidence = 5.0 / 3.0;  // deviations / `evidence`

// Adds the evidence of the regions R_2 that touch a piece.
void add_wide_evidence(const Signal& signal, const Plane& noise, double evidence, Plane& beyond) {
  const Plane mean = region_mean(signal.mean, kWideLevel);
  const Plane mean_noise = variance_over_region(noise, kWideLevel);
  const double own_share = 1.0 - 2.0 / (1 << 2 * kWideLevel);
  add_evidence({signal.variance, signal.variance, signal.mean, mean, noise, mean_noise, own_share},
               kWideEvidence * kWideEvidence * evidence * evidence, beyond);
}

// 1 where the raw mean stays.
Plane refusals(const DirectionalOptions& options, const Tile& tile, Views* views,
               GuardCounts& guards) {
  const Taps taps = base_taps(options.base), squares = squared_base_taps(options.base);
  const std::vector<Signal> signals = deciding_signals(tile);
  const FilterSizeInput first{signals[0].mean,  signals[0].variance,   tile.n,
                              tile.minimum,     tile.maximum,          {},
                              tile.attenuation, options.pyramid.levels};
  const Plane w = size_factors(first, 0, options.size, guards);
  SizeCriterion criterion;
  Plane wide;
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  for (const Signal& signal : signals) {
    const Plane mean = convolve(signal.mean, taps), variance = convolve(signal.variance, squares);
    Plane noise, base_noise;
    if (options.size.evidence > 0.0) {
      noise = cautious_variance(signal.variance);
      base_noise = convolve(noise, squares);
      add_wide_evidence(signal, noise, options.size.evidence, wide);
    }
    add_step({signal.variance, variance, signal.mean, mean, noise, base_noise,
              1.0 - 2.0 * middle * middle, false},
             w, signals.size(), options.size.evidence, criterion);
  }
  Plane raw = decide_stops(criterion, -1, options.size.smooth, guards);
  for (std::size_t i = 0; i < wide.size(); ++i) {
    if (wide[i] > 0.0) raw[i] = 1.0;
  }
  if (views) {
    views->add("T.base", criterion.t);
    views->add("stop.base", raw);
  }
  return raw;
}

// `plane` filtered where `raw`, if there is one, is 0.
void filter_others(const Plane& raw, const Taps& taps, Plane& plane) {
  Plane filtered = convolve(plane, taps);
  parallel_rows(0, raw.height(), [&](int y) {
    for (int x = 0; x < raw.width(); ++x) {
      if (raw(x, y) > 0.0) filtered(x, y) = plane(x, y);
    }
  });
  plane = std::move(filtered);
}

}  // namespace

Plane apply_base(const DirectionalOptions& options, Tile& tile, Views* views, GuardCounts& guards) {
  if (options.base == BaseImage::kNone) return {};
  Plane raw;
  if (options.base == BaseImage::kChosen) raw = refusals(options, tile, views, guards);
  const Taps taps = base_taps(options.base), squares = squared_base_taps(options.base);
  for (Plane& channel : tile.pieces.mean)
    filter_others(raw, taps, channel);
  for (Plane& channel : tile.pieces.variance)
    filter_others(raw, squares, channel);
  filter_others(raw, taps, tile.analysis.mean);
  filter_others(raw, squares, tile.analysis.variance);
  for (SizeChannel& channel : tile.channels) {
    filter_others(raw, taps, channel.mean);
    filter_others(raw, squares, channel.variance);
  }
  return raw;
}

}  // namespace spool
