#include "lib/metrics/error_metrics.h"

#include <cmath>
#include <utility>

#include "lib/metrics/bootstrap.h"
#include "lib/metrics/largest_first.h"
#include "lib/metrics/metric_list.h"
#include "lib/metrics/metric_values.h"
#include "lib/metrics/perceptual_metrics.h"
#include "lib/metrics/pixel_errors.h"

namespace spool {
namespace {

void add_perceptual(const PixelErrors& errors, const JudgingReference& reference,
                    const BlockBootstrap& bootstrap, MetricTable& table) {
  const MetricOptions& options = errors.options();
  PerceptualTable found =
      perceptual_metrics({errors.estimate(), reference.mean, errors.side(), errors.luma()},
                         bootstrap, options.perceptual, table.guards,
                         [&](std::string_view name) { return is_wanted(options, name); });
  table.flip = std::move(found.flip);
  for (PerceptualValue& value : found.values) {
    const auto m = static_cast<std::size_t>(metric_index(value.name));
    table.values[m] = {value.estimate.value, value.estimate.standard_error};
    table.resampled[m] = std::move(value.resampled);
  }
}

MetricTable table_of(const PixelErrors& errors, const JudgingReference& reference,
                     const BlockBootstrap& bootstrap) {
  const MetricOptions& options = errors.options();
  MetricTable table;
  table.values.resize(metric_list().size());
  table.resampled.resize(metric_list().size());
  table.blocks = bootstrap.blocks();
  table.relative_scale = errors.relative_scale();
  table.pixels = errors.pixels();
  table.excluded_estimate = errors.excluded_estimate();
  table.excluded_reference = errors.excluded_reference();
  table.failed = table.excluded_estimate > 0;
  table.guards = errors.guards();
  if (table.pixels == 0) return table;
  add_perceptual(errors, reference, bootstrap, table);
  MetricValues values(errors, bootstrap);
  if (options.support) {
    table.squared = values.squared_support();
    table.relative = values.relative_support();
  }
  for (std::size_t m = 0; m < metric_list().size(); ++m) {
    const Metric& metric = metric_list()[m];
    if (metric.rule == Rule::kPerceptual || !is_wanted(options, m)) continue;
    table.values[m].value = values.value(metric, kWhole);
    if (!values.has_standard_error(metric)) continue;
    std::vector<double>& resampled = table.resampled[m];
    for (int r = 0; r < bootstrap.resamples(); ++r)
      resampled.push_back(values.value(metric, r));
    table.values[m].standard_error = standard_error_of(resampled);
  }
  return table;
}

// The pixels that relmse_trimmed leaves out become 0, and the mean is over the others.
Plane trimmed_map(Plane relative, const PixelErrors& errors) {
  const double count = static_cast<double>(errors.pixels());
  const double dropped = trimmed_pixels(count, errors.options());
  double left = dropped;
  LargestFirst(relative, errors.judged()).walk([&](const LargestFirst::Entry& entry) {
    if (left < 1.0) return false;
    relative[entry.pixel] = 0.0;
    left -= 1.0;
    return true;
  });
  for (double& value : relative.pixels())
    value *= quotient(count, count - dropped);
  return relative;
}

std::vector<ErrorMap> maps_of(const PixelErrors& errors, const BlockBootstrap& bootstrap) {
  if (errors.pixels() == 0) return {};
  MetricValues values(errors, bootstrap);
  const double count = static_cast<double>(errors.pixels());
  const double reference = values.sum(kReferenceEnergy, kWhole);
  Plane squared(errors.judged().width(), errors.judged().height());
  Plane symmetric = squared, energy = squared;
  for (std::size_t p = 0; p < errors.judged().size(); ++p) {
    if (!errors.judged()[p]) continue;
    const PixelTerms terms = errors.terms(p);
    squared[p] = terms[kSquared];
    symmetric[p] = terms[kSymmetric];
    energy[p] = quotient(terms[kEnergy] * count, reference);
  }
  std::vector<ErrorMap> maps = {{"mse", std::move(squared)},
                                {"relmse", values.relative()},
                                {"relmse_trimmed", trimmed_map(values.relative(), errors)},
                                {"smape", std::move(symmetric)},
                                {"energy_ratio", std::move(energy)}};
  if (errors.wanted().flip)
    maps.push_back({"flip_ldr", flip_map(errors.estimate(), errors.side())});
  return maps;
}

void check_sizes(const RgbImage& estimate, const JudgingReference& reference) {
  for (std::size_t c = 0; c < 3; ++c) {
    SPOOL_CHECK(estimate[c].same_size(estimate[0]));
    SPOOL_CHECK(reference.mean[c].same_size(estimate[0]));
    if (reference.variance) SPOOL_CHECK((*reference.variance)[c].same_size(estimate[0]));
    if (reference.denominator) SPOOL_CHECK((*reference.denominator)[c].same_size(estimate[0]));
  }
}

}  // namespace

bool is_the_reference(const RgbImage& image, const RgbImage& reference) {
  constexpr double kNear = 1e-3;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < image[c].size(); ++p) {
      const double r = reference[c][p];
      if (!(std::abs(image[c][p] - r) <= kNear * std::abs(r))) return false;
    }
  }
  return true;
}

MetricTable error_metrics(const RgbImage& estimate, const JudgingReference& reference,
                          const MetricOptions& options) {
  check_sizes(estimate, reference);
  return table_of({estimate, reference, options, wanted_terms(options, false)}, reference,
                  {estimate[0].width(), estimate[0].height(), options.bootstrap});
}

std::vector<ErrorMap> error_maps(const RgbImage& estimate, const JudgingReference& reference,
                                 const MetricOptions& options) {
  check_sizes(estimate, reference);
  MetricOptions of_maps = options;  // none of them is made of tone-mapped pixels or of deciles
  of_maps.wanted.assign(metrics().size(), false);
  of_maps.support = false;
  std::vector<ErrorMap> maps =
      maps_of({estimate, reference, of_maps, wanted_terms(of_maps, is_wanted(options, "flip_ldr"))},
              {estimate[0].width(), estimate[0].height(), options.bootstrap});
  std::erase_if(maps, [&](const ErrorMap& map) { return !is_wanted(options, map.metric); });
  return maps;
}

Plane squared_error_map(const RgbImage& estimate, const JudgingReference& reference) {
  check_sizes(estimate, reference);
  Plane map(estimate[0].width(), estimate[0].height());
  for (std::size_t p = 0; p < map.size(); ++p) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = estimate[c][p] - reference.mean[c][p];
      sum += difference * difference - (reference.variance ? (*reference.variance)[c][p] : 0.0);
    }
    map[p] = std::isfinite(sum) ? sum / 3.0 : std::numeric_limits<double>::quiet_NaN();
  }
  return map;
}

}  // namespace spool
