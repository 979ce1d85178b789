#include "lib/metrics/metric_values.h"

#include <algorithm>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kWorstPixels = 1e-3;   // share of the pixels
constexpr double kLargeFactor = 100.0;  // on an image that has lost its energy
constexpr double kLeastKept = 1e-6;     // of what is dropped: less is its rounding

// Debiased errors may be below 0: these then are not defined.
double root_of(double ratio) {
  return std::isless(ratio, 0.0) ? kNaN : std::sqrt(ratio);
}
double decibel_of(double ratio) {
  if (ratio == 0.0) return -std::numeric_limits<double>::infinity();
  return std::isless(ratio, 0.0) ? kNaN : 10.0 * std::log10(ratio);
}

}  // namespace

// The factor keeps ceil from counting the rounding of trim * count as one pixel more.
double trimmed_pixels(double count, const MetricOptions& options) {
  return std::ceil(options.trim * count * (1.0 - 1e-12));
}

MetricValues::MetricValues(const PixelErrors& errors, const BlockBootstrap& bootstrap)
    : errors_(errors),
      bootstrap_(bootstrap),
      relative_(errors.judged().width(), errors.judged().height()),
      squared_(errors.judged().width(), errors.judged().height()) {
  add_up_blocks();
}

double MetricValues::value(const Metric& metric, int resample) {
  switch (metric.rule) {
    case Rule::kRatio:
      return ratio(metric, resample);
    case Rule::kRootRatio:
      return root_of(ratio(metric, resample));
    case Rule::kDecibel:
      return decibel_of(
          quotient(sum(metric.denominator, resample), sum(metric.numerator, resample)));
    case Rule::kTrimmed:
    case Rule::kDropped:
      return trimmed(metric.rule, resample);
    case Rule::kQuantile:
    case Rule::kMaximum:
      return of_rank(metric.rule, resample);
    case Rule::kEqualEnergy:
    case Rule::kEqualDeciles:
      return equal_energy(metric, resample);
    case Rule::kPerceptual:
      break;
  }
  return kNaN;
}

bool MetricValues::has_standard_error(const Metric& metric) const {
  return metric.rule != Rule::kMaximum &&
         in_several_blocks(sums_[static_cast<std::size_t>(metric.denominator)]);
}

ErrorSupport MetricValues::squared_support() {
  return support(squared_, largest_squared(), kDecileSquares);
}

ErrorSupport MetricValues::relative_support() {
  return support(relative_, largest_relative(), kDecileRelativeSquares);
}

void MetricValues::add_up_blocks() {
  const auto blocks = static_cast<std::size_t>(bootstrap_.blocks());
  for (std::vector<double>& sums : sums_)
    sums.assign(blocks, 0.0);
  parallel_for(blocks, [&](std::size_t b) {
    const Rectangle bounds = bootstrap_.block_bounds(static_cast<int>(b));
    Terms sums{};
    for (int y = bounds.y0; y < bounds.y1; ++y) {
      for (int x = bounds.x0; x < bounds.x1; ++x) {
        const std::size_t p = errors_.judged().index(x, y);
        if (!errors_.judged()[p]) continue;
        const PixelTerms terms = errors_.terms(p);
        for (std::size_t t = 0; t < terms.size(); ++t)
          sums[t] += terms[t];
        if (errors_.wanted().deciles) {
          sums[kDecileEnergy + errors_.side().decile[p]] += terms[kEnergy];
          sums[kDecileReferenceEnergy + errors_.side().decile[p]] += terms[kReferenceEnergy];
        }
        if (errors_.wanted().squares) errors_.add_squares(p, sums);
        relative_[p] = terms[kRelative];
        squared_[p] = terms[kRawSquared];
      }
    }
    for (std::size_t t = 0; t < kTermCount; ++t)
      sums_[t][b] = sums[t];
  });
}

// Of a resample, or of the whole.
double MetricValues::sum(int term, int resample) {
  const auto t = static_cast<std::size_t>(term);
  if (resample == kWhole) return weighted_sum(sums_[t], {});
  if (resampled_[t].empty()) resampled_[t] = resampled_sums(sums_[t], bootstrap_);
  return resampled_[t][static_cast<std::size_t>(resample)];
}

double MetricValues::ratio(const Metric& metric, int resample) {
  return quotient(sum(metric.numerator, resample), sum(metric.denominator, resample));
}

double MetricValues::trimmed(Rule rule, int resample) {
  const double count = sum(kCount, resample), to_drop = trimmed_pixels(count, errors_.options());
  double left = to_drop, dropped = 0.0;
  largest_relative().walk([&](const LargestFirst::Entry& entry) {
    if (left <= 0.0) return false;
    const double copies = std::min(left, copies_of(entry.pixel, resample));
    dropped += copies * entry.value;
    left -= copies;
    return true;
  });
  if (rule == Rule::kDropped) return quotient(dropped, count);
  double kept = sum(kRelative, resample) - dropped;
  if (!(std::abs(kept) >= kLeastKept * dropped))  // or a square too large for a number
    kept = sum_behind(to_drop, resample);
  return quotient(kept, count - to_drop);
}

double MetricValues::of_rank(Rule rule, int resample) {
  double skip = rule == Rule::kMaximum ? 0.0 : std::floor(sum(kCount, resample) / 1e3);
  double found = kNaN;
  largest_squared().walk([&](const LargestFirst::Entry& entry) {
    skip -= copies_of(entry.pixel, resample);
    found = entry.value;
    return skip >= 0.0;
  });
  return found;
}

double MetricValues::equal_energy(const Metric& metric, int resample) {
  const int together = metric.rule == Rule::kEqualEnergy ? kDeciles : 1;
  double error = 0.0;
  for (int d = 0; d < kDeciles; d += together)
    error += scaled_error(metric.numerator, d, d + together, resample);
  return quotient(error, sum(kCount, resample));
}

// The squares of deciles first .. last-1 (numbered from `squares`) with the image times the
// factor that gives these deciles together the energy of the reference; 1 where they have none to
// scale.
double MetricValues::scaled_error(int squares, int first, int last, int resample) {
  double image = 0.0, reference = 0.0;
  std::array<double, kSquareTerms> terms{};
  for (int d = first; d < last; ++d) {
    image += sum(kDecileEnergy + d, resample);
    reference += sum(kDecileReferenceEnergy + d, resample);
    for (int t = 0; t < kSquareTerms; ++t)
      terms[static_cast<std::size_t>(t)] += sum(squares + kSquareTerms * d + t, resample);
  }
  const double g = image > 0.0 ? reference / image : 1.0;
  if (g > kLargeFactor) {
    return (g - 1.0) * (g - 1.0) * terms[kImageSquared] + 2.0 * (g - 1.0) * terms[kErrorImage] +
           terms[kErrorSquared] - terms[kVariance];
  }
  return g * g * terms[kErrorSquared] + 2.0 * g * (g - 1.0) * terms[kErrorReference] +
         (g - 1.0) * (g - 1.0) * terms[kReferenceSquared] - terms[kVariance];
}

double MetricValues::copies_of(std::size_t pixel, int resample) const {
  if (resample == kWhole) return 1.0;
  const auto width = static_cast<std::size_t>(errors_.judged().width());
  return bootstrap_.weights(resample)[static_cast<std::size_t>(
      bootstrap_.block_of(static_cast<int>(pixel % width), static_cast<int>(pixel / width)))];
}

// Of all errors but the largest `drop`, added up without them.
double MetricValues::sum_behind(double drop, int resample) {
  double sum = 0.0;
  largest_relative().walk([&](const LargestFirst::Entry& entry) {
    const double copies = copies_of(entry.pixel, resample), dropped = std::min(drop, copies);
    drop -= dropped;
    if (copies > dropped) sum += (copies - dropped) * entry.value;
    return true;
  });
  return sum;
}

LargestFirst& MetricValues::largest_squared() {
  if (!largest_squared_) largest_squared_.emplace(squared_, errors_.judged());
  return *largest_squared_;
}

LargestFirst& MetricValues::largest_relative() {
  if (!largest_relative_) largest_relative_.emplace(relative_, errors_.judged());
  return *largest_relative_;
}

// Of what the pixels have above 0: debiased errors may lie below.
ErrorSupport MetricValues::support(const Plane& values, LargestFirst& largest, int squares) {
  const double all = pairwise_sum(values.size(), [&](std::size_t p) {
    return errors_.judged()[p] && values[p] > 0.0 ? values[p] : 0.0;
  });
  ErrorSupport found;
  const double worst = std::ceil(kWorstPixels * static_cast<double>(errors_.pixels()));
  double walked = 0.0, of_worst = 0.0, half = 0.0, borne = 0.0;
  largest.walk([&](const LargestFirst::Entry& entry) {
    if (walked < worst && entry.value > 0.0) of_worst += entry.value;
    if (borne < 0.5 * all) half += 1.0, borne += entry.value;
    return ++walked < worst || borne < 0.5 * all;
  });
  if (all > 0.0) {
    found.worst_share = of_worst / all;
    found.half_pixels = half;
  }
  if (!errors_.is_debiased()) return found;
  double noise = 0.0;
  for (int d = 0; d < kDeciles; ++d)
    noise += sum(squares + kSquareTerms * d + kVariance, kWhole);
  found.reference_noise = quotient(noise, sum(kCount, kWhole));
  return found;
}

}  // namespace spool
