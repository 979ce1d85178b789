#include "lib/metrics/error_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/metrics/largest_first.h"
#include "lib/metrics/metric_list.h"
#include "lib/metrics/tone_map.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSmallestScale = 0x1p-126;  // mean luminance; as in the analysis
constexpr double kAbsoluteFloor = 1e-2;      // of relmae and smape, after the relative scale
constexpr double kWorstPixels = 1e-3;        // share of the pixels
constexpr double kLargeFactor = 100.0;       // on an image that has lost its energy
constexpr double kLeastKept = 1e-6;          // of what is dropped: less is its rounding
constexpr int kWhole = -1;                   // the image instead of a resample of its blocks

bool is_finite(const RgbImage& image, std::size_t p) {
  return std::isfinite(image[0][p]) && std::isfinite(image[1][p]) && std::isfinite(image[2][p]);
}

double luminance_at(const RgbImage& image, std::size_t p) {
  return luminance(image[0][p], image[1][p], image[2][p]);
}

// Debiased errors may be below 0: these then are not defined.
double root_of(double ratio) {
  return std::isless(ratio, 0.0) ? kNaN : std::sqrt(ratio);
}
double decibel_of(double ratio) {
  if (ratio == 0.0) return -std::numeric_limits<double>::infinity();
  return std::isless(ratio, 0.0) ? kNaN : 10.0 * std::log10(ratio);
}

// Everything that is computed once per pair of images and looked at once per resample.
class Evaluation {
 public:
  // `flip`: its map is asked for, whatever metrics are wanted.
  Evaluation(const RgbImage& estimate, const JudgingReference& reference,
             const MetricOptions& options, bool flip)
      : estimate_(estimate),
        reference_(reference),
        options_(options),
        flip_(flip),
        bootstrap_(estimate[0].width(), estimate[0].height(), options.bootstrap),
        judged_(estimate[0].width(), estimate[0].height()) {
    select_pixels();
    if (table_.pixels == 0) return;
    if (reference.variance && !equals_reference()) variance_ = &*reference.variance;
    choose_scale();
    make_sides();
    add_up_blocks();
  }

  MetricTable table() {
    table_.values.resize(metric_list().size());
    table_.resampled.resize(metric_list().size());
    table_.blocks = bootstrap_.blocks();
    if (table_.pixels == 0) return std::move(table_);
    add_perceptual();
    if (options_.support) {
      table_.squared = support(squared_, largest(largest_squared_, squared_), kDecileSquares);
      table_.relative =
          support(relative_, largest(largest_relative_, relative_), kDecileRelativeSquares);
    }
    for (std::size_t m = 0; m < metric_list().size(); ++m) {
      const Metric& metric = metric_list()[m];
      if (metric.rule == Rule::kPerceptual || !wants(m)) continue;
      table_.values[m].value = value(metric, kWhole);
      if (metric.rule == Rule::kMaximum || !in_several_blocks(sums_of(metric.denominator)))
        continue;
      std::vector<double>& resampled = table_.resampled[m];
      for (int r = 0; r < bootstrap_.resamples(); ++r)
        resampled.push_back(value(metric, r));
      table_.values[m].standard_error = standard_error_of(resampled);
    }
    return std::move(table_);
  }

  std::vector<ErrorMap> maps() {
    const Plane empty(judged_.width(), judged_.height());
    std::vector<ErrorMap> maps = {{"mse", empty},
                                  {"relmse", relative_},
                                  {"relmse_trimmed", relative_},
                                  {"smape", empty},
                                  {"energy_ratio", empty}};
    if (table_.pixels == 0) return {};
    const double count = static_cast<double>(table_.pixels),
                 reference = sum(kReferenceEnergy, kWhole);
    for (std::size_t p = 0; p < judged_.size(); ++p) {
      if (!judged_[p]) continue;
      const PixelTerms terms = terms_at(p);
      maps[0].parts[p] = terms[kSquared];
      maps[3].parts[p] = terms[kSymmetric];
      maps[4].parts[p] = quotient(terms[kEnergy] * count, reference);
    }
    trim(maps[2].parts);
    if (flip_ && options_.perceptual != Perceptual::kNone)
      maps.push_back({"flip_ldr", flip_map(estimate_, *side_)});
    return maps;
  }

 private:
  // The pixels that relmse_trimmed drops become 0, and the mean is over the others.
  void trim(Plane& relative) {
    const double count = static_cast<double>(table_.pixels);
    const double dropped = std::ceil(options_.trim * count * (1.0 - 1e-12));
    double left = dropped;
    LargestFirst(relative_, judged_).walk([&](const LargestFirst::Entry& entry) {
      if (left < 1.0) return false;
      relative[entry.pixel] = 0.0;
      left -= 1.0;
      return true;
    });
    for (double& value : relative.pixels())
      value *= quotient(count, count - dropped);
  }

  // Of what the pixels have above 0: debiased errors may lie below.
  ErrorSupport support(const Plane& values, LargestFirst& errors, int squares) const {
    const double all = pairwise_sum(values.size(), [&](std::size_t p) {
      return judged_[p] && values[p] > 0.0 ? values[p] : 0.0;
    });
    ErrorSupport found;
    const double worst = std::ceil(kWorstPixels * static_cast<double>(table_.pixels));
    double walked = 0.0, of_worst = 0.0, half = 0.0, borne = 0.0;
    errors.walk([&](const LargestFirst::Entry& entry) {
      if (walked < worst && entry.value > 0.0) of_worst += entry.value;
      if (borne < 0.5 * all) half += 1.0, borne += entry.value;
      return ++walked < worst || borne < 0.5 * all;
    });
    if (all > 0.0) {
      found.worst_share = of_worst / all;
      found.half_pixels = half;
    }
    if (!variance_) return found;
    double noise = 0.0;
    for (int d = 0; d < kDeciles; ++d)
      noise += sum(squares + kSquareTerms * d + kVariance, kWhole);
    found.reference_noise = quotient(noise, sum(kCount, kWhole));
    return found;
  }

  bool wants(std::size_t m) const { return options_.wanted.empty() || options_.wanted[m]; }
  // Whether a wanted metric is one of those that `belongs` says yes to.
  template <class Belongs>
  bool wants_one(const Belongs& belongs) const {
    for (std::size_t m = 0; m < metric_list().size(); ++m) {
      if (wants(m) && belongs(metric_list()[m])) return true;
    }
    return false;
  }

  void add_perceptual() {
    const auto wanted = [&](std::string_view name) { return wants_named(name); };
    PerceptualTable found =
        perceptual_metrics({estimate_, reference_.mean, *side_, luma_}, bootstrap_,
                           options_.perceptual, table_.guards, wanted);
    table_.flip = std::move(found.flip);
    for (PerceptualValue& value : found.values) {
      const auto m = static_cast<std::size_t>(metric_index(value.name));
      table_.values[m] = {value.estimate.value, value.estimate.standard_error};
      table_.resampled[m] = std::move(value.resampled);
    }
  }

  void select_pixels() {
    for (std::size_t p = 0; p < judged_.size(); ++p) {
      if (!is_finite(estimate_, p)) {
        ++table_.excluded_estimate;
      } else if (!is_finite(reference_.mean, p) ||
                 (reference_.variance && !is_finite(*reference_.variance, p)) ||
                 (reference_.denominator && !is_finite(*reference_.denominator, p))) {
        ++table_.excluded_reference;
      } else {
        judged_[p] = 1;
        ++table_.pixels;
      }
    }
    table_.failed = table_.excluded_estimate > 0;
    table_.guards.add(Guard::kMetricExcluded, table_.excluded_estimate + table_.excluded_reference);
  }

  bool equals_reference() const {
    for (std::size_t p = 0; p < judged_.size(); ++p) {
      for (std::size_t c = 0; judged_[p] && c < 3; ++c)
        if (estimate_[c][p] != reference_.mean[c][p]) return false;
    }
    return true;
  }

  void choose_scale() {
    if (options_.rel_scale == RelativeScale::kNone) return;
    const double sum = pairwise_sum(judged_.size(), [&](std::size_t p) {
      return judged_[p] ? luminance_at(reference_.mean, p) : 0.0;
    });
    const double mean = sum / static_cast<double>(table_.pixels);
    if (std::isfinite(mean) && mean >= kSmallestScale) {
      table_.relative_scale = 1.0 / mean;
    } else {
      table_.guards.add(Guard::kExposureFallback);
    }
  }

  const RgbImage& denominator() const {
    return reference_.denominator ? *reference_.denominator : reference_.mean;
  }

  bool wants_named(std::string_view name) const {
    return wants(static_cast<std::size_t>(metric_index(name)));
  }

  // What is made of the reference alone, and the tone-mapped estimate.
  void make_sides() {
    const bool luma =
        options_.perceptual != Perceptual::kNone && (wants_named("ssim") || wants_named("ms_ssim"));
    const bool flip =
        options_.perceptual != Perceptual::kNone && (flip_ || wants_named("flip_ldr"));
    const SideParts parts{tone_ || luma, flip, deciles_};
    side_ = reference_.kept ? reference_.kept->of(reference_.mean, denominator(), judged_, parts)
                            : std::make_shared<const ReferenceSide>(
                                  reference_side(reference_.mean, denominator(), judged_, parts));
    if (!parts.tone) return;
    luma_ = Plane(judged_.width(), judged_.height(), kNaN);
    tone_squared_ = Plane(judged_.width(), judged_.height());
    parallel_rows(0, judged_.height(), [&](int y) {
      for (int x = 0; x < judged_.width(); ++x)
        if (const std::size_t p = judged_.index(x, y); judged_[p]) tone_map_pixel(p);
    });
  }

  void tone_map_pixel(std::size_t p) {
    std::array<double, 3> tone;
    for (std::size_t c = 0; c < 3; ++c) {
      tone[c] = tone_mapped(estimate_[c][p], side_->exposure);
      const double difference = tone[c] - side_->tone[c][p];
      tone_squared_[p] += difference * difference / 3.0;
    }
    luma_[p] = luminance(tone[0], tone[1], tone[2]);
  }

  // What the error of a channel is divided by in relmse, radiance units.
  double divisor_of(std::size_t c, std::size_t p) const {
    return options_.rel_denominator == RelativeDenominator::kLuminance
               ? luminance_at(denominator(), p)
               : denominator()[c][p];
  }
  // Of the squared error times the squared relative scale.
  double relative_divisor(std::size_t c, std::size_t p) const {
    const double d = table_.relative_scale * divisor_of(c, p);
    return d * d + options_.rel_eps;
  }

  PixelTerms terms_at(std::size_t p) const {
    PixelTerms terms{};
    terms[kCount] = 1.0;
    const double scale = table_.relative_scale;
    for (std::size_t c = 0; c < 3; ++c) {
      const double i = estimate_[c][p], r = reference_.mean[c][p];
      const double b = variance_ ? (*variance_)[c][p] : 0.0;
      const double raw = (i - r) * (i - r), squared = raw - b;
      const double relative = scale * scale * squared / relative_divisor(c, p);
      const double difference = std::abs(i - r);
      terms[kSquared] += squared / 3.0;
      terms[kSquaredOf + c] = squared;
      terms[kRawSquared] += raw / 3.0;
      terms[kRelative] += relative / 3.0;
      const double plain = divisor_of(c, p);
      terms[kRelativePlain] += squared / (plain * plain + options_.rel_eps) / 3.0;
      terms[kRelativeOf + c] = relative;
      terms[kAbsolute] += difference / 3.0;
      terms[kRelativeAbsolute] += scale * difference / (scale * std::abs(r) + kAbsoluteFloor) / 3.0;
      terms[kSymmetric] +=
          scale * difference / (scale * (std::abs(i) + std::abs(r)) + kAbsoluteFloor) / 3.0;
      terms[kEnergy] += i;
      terms[kReferenceEnergy] += r;
    }
    if (tone_) terms[kToneSquared] = tone_squared_[p];
    return terms;
  }

  void add_squares(std::size_t p, Terms& sums) const {
    const double scale = table_.relative_scale;
    const std::ptrdiff_t first = kSquareTerms * std::ptrdiff_t{side_->decile[p]};
    for (std::size_t c = 0; c < 3; ++c) {
      const double i = estimate_[c][p], r = reference_.mean[c][p], difference = i - r;
      const double b = variance_ ? (*variance_)[c][p] : 0.0;
      const double weight = scale * scale / relative_divisor(c, p);
      const std::array<double, kSquareTerms> squares = {
          difference * difference, difference * r, r * r, difference * i, i * i, b};
      for (std::ptrdiff_t t = 0; t < kSquareTerms; ++t) {
        const double square = squares[static_cast<std::size_t>(t)] / 3.0;
        sums[static_cast<std::size_t>(kDecileSquares + first + t)] += square;
        sums[static_cast<std::size_t>(kDecileRelativeSquares + first + t)] += weight * square;
      }
    }
  }

  void add_up_blocks() {
    const auto blocks = static_cast<std::size_t>(bootstrap_.blocks());
    for (std::vector<double>& sums : sums_)
      sums.assign(blocks, 0.0);
    relative_ = Plane(judged_.width(), judged_.height());
    squared_ = Plane(judged_.width(), judged_.height());
    parallel_for(blocks, [&](std::size_t b) {
      const Rectangle bounds = bootstrap_.block_bounds(static_cast<int>(b));
      Terms sums{};
      for (int y = bounds.y0; y < bounds.y1; ++y) {
        for (int x = bounds.x0; x < bounds.x1; ++x) {
          const std::size_t p = judged_.index(x, y);
          if (!judged_[p]) continue;
          const PixelTerms terms = terms_at(p);
          for (std::size_t t = 0; t < terms.size(); ++t)
            sums[t] += terms[t];
          if (deciles_) {
            sums[kDecileEnergy + side_->decile[p]] += terms[kEnergy];
            sums[kDecileReferenceEnergy + side_->decile[p]] += terms[kReferenceEnergy];
          }
          if (squares_) add_squares(p, sums);
          relative_[p] = terms[kRelative];
          squared_[p] = terms[kRawSquared];
        }
      }
      for (std::size_t t = 0; t < kTermCount; ++t)
        sums_[t][b] = sums[t];
    });
  }

  const std::vector<double>& sums_of(int term) const {
    return sums_[static_cast<std::size_t>(term)];
  }

  // Of a resample, or of the whole.
  double sum(int term, int resample) const {
    const auto t = static_cast<std::size_t>(term);
    if (resample == kWhole) return weighted_sum(sums_[t], {});
    if (resampled_[t].empty()) resampled_[t] = resampled_sums(sums_[t], bootstrap_);
    return resampled_[t][static_cast<std::size_t>(resample)];
  }

  double ratio(const Metric& metric, int resample) const {
    return quotient(sum(metric.numerator, resample), sum(metric.denominator, resample));
  }

  // The squares of deciles first .. last-1 (numbered from `squares`) with the image times the
  // factor that gives these deciles together the energy of the reference; 1 where they have none to
  // scale.
  double scaled_error(int squares, int first, int last, int resample) const {
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

  double equal_energy(const Metric& metric, int resample) const {
    const int together = metric.rule == Rule::kEqualEnergy ? kDeciles : 1;
    double error = 0.0;
    for (int d = 0; d < kDeciles; d += together)
      error += scaled_error(metric.numerator, d, d + together, resample);
    return quotient(error, sum(kCount, resample));
  }

  // Sorted when the first metric asks for it.
  LargestFirst& largest(std::optional<LargestFirst>& sorted, const Plane& values) const {
    if (!sorted) sorted.emplace(values, judged_);
    return *sorted;
  }

  double value(const Metric& metric, int resample) {
    switch (metric.rule) {
      case Rule::kRatio:
        return ratio(metric, resample);
      case Rule::kRootRatio:
        return root_of(ratio(metric, resample));
      case Rule::kDecibel:
        return decibel_of(
            quotient(sum(metric.denominator, resample), sum(metric.numerator, resample)));
      case Rule::kTrimmed:
      case Rule::kDropped: {
        const double count = sum(kCount, resample);
        // The factor keeps ceil from counting the rounding of trim * count as one pixel more.
        const double to_drop = std::ceil(options_.trim * count * (1.0 - 1e-12));
        double left = to_drop, dropped = 0.0;
        LargestFirst& errors = largest(largest_relative_, relative_);
        errors.walk([&](const LargestFirst::Entry& entry) {
          if (left <= 0.0) return false;
          const double copies = std::min(left, copies_of(entry.pixel, resample));
          dropped += copies * entry.value;
          left -= copies;
          return true;
        });
        if (metric.rule == Rule::kDropped) return quotient(dropped, count);
        double kept = sum(kRelative, resample) - dropped;
        if (!(std::abs(kept) >= kLeastKept * dropped))  // or a square too large for a number
          kept = sum_behind(errors, to_drop, resample);
        return quotient(kept, count - to_drop);
      }
      case Rule::kQuantile:
      case Rule::kMaximum: {
        double skip = metric.rule == Rule::kMaximum ? 0.0 : std::floor(sum(kCount, resample) / 1e3);
        double found = kNaN;
        largest(largest_squared_, squared_).walk([&](const LargestFirst::Entry& entry) {
          skip -= copies_of(entry.pixel, resample);
          found = entry.value;
          return skip >= 0.0;
        });
        return found;
      }
      case Rule::kEqualEnergy:
      case Rule::kEqualDeciles:
        return equal_energy(metric, resample);
      case Rule::kPerceptual:
        break;
    }
    return kNaN;
  }

  // Of all errors but the largest `drop`, added up without them.
  double sum_behind(LargestFirst& errors, double drop, int resample) const {
    double sum = 0.0;
    errors.walk([&](const LargestFirst::Entry& entry) {
      const double copies = copies_of(entry.pixel, resample), dropped = std::min(drop, copies);
      drop -= dropped;
      if (copies > dropped) sum += (copies - dropped) * entry.value;
      return true;
    });
    return sum;
  }

  double copies_of(std::size_t pixel, int resample) const {
    if (resample == kWhole) return 1.0;
    const auto width = static_cast<std::size_t>(judged_.width());
    return bootstrap_.weights(resample)[static_cast<std::size_t>(
        bootstrap_.block_of(static_cast<int>(pixel % width), static_cast<int>(pixel / width)))];
  }

  const RgbImage& estimate_;
  const JudgingReference& reference_;
  const RgbImage* variance_ = nullptr;  // b, where it is subtracted
  const MetricOptions& options_;
  const bool flip_;
  // Whether a wanted metric is made of tone-mapped pixels, of deciles, of their squares.
  const bool tone_ = wants_one([](const Metric& m) { return m.rule == Rule::kDecibel; });
  const bool squares_ = options_.support || wants_one([](const Metric& m) {
                          return m.rule == Rule::kEqualEnergy || m.rule == Rule::kEqualDeciles;
                        });
  const bool deciles_ = squares_ || wants_one([](const Metric& m) {
                          return m.rule == Rule::kRatio && m.numerator >= kDecileEnergy;
                        });
  BlockBootstrap bootstrap_;
  Image<std::uint8_t> judged_;
  std::shared_ptr<const ReferenceSide> side_;
  Plane luma_, tone_squared_;                                      // of the tone-mapped estimate
  std::array<std::vector<double>, kTermCount> sums_;               // [term][block]
  mutable std::array<std::vector<double>, kTermCount> resampled_;  // [term][resample], when asked
  Plane relative_, squared_;  // per pixel: relMSE debiased, squared error raw
  std::optional<LargestFirst> largest_relative_, largest_squared_;
  MetricTable table_;
};

void check_sizes(const RgbImage& estimate, const JudgingReference& reference) {
  for (std::size_t c = 0; c < 3; ++c) {
    SPOOL_CHECK(estimate[c].same_size(estimate[0]));
    SPOOL_CHECK(reference.mean[c].same_size(estimate[0]));
    if (reference.variance) SPOOL_CHECK((*reference.variance)[c].same_size(estimate[0]));
    if (reference.denominator) SPOOL_CHECK((*reference.denominator)[c].same_size(estimate[0]));
  }
}

}  // namespace

const MetricValue& MetricTable::operator[](std::string_view name) const {
  const int index = metric_index(name);
  SPOOL_CHECK_GE(index, 0);
  SPOOL_CHECK_LT(static_cast<std::size_t>(index), values.size());
  return values[static_cast<std::size_t>(index)];
}

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
  return Evaluation(estimate, reference, options, false).table();
}

std::vector<ErrorMap> error_maps(const RgbImage& estimate, const JudgingReference& reference,
                                 const MetricOptions& options) {
  check_sizes(estimate, reference);
  const auto wanted = [&](std::string_view name) {
    return options.wanted.empty() || options.wanted[static_cast<std::size_t>(metric_index(name))];
  };
  MetricOptions of_maps = options;  // none of them is made of tone-mapped pixels or of deciles
  of_maps.wanted.assign(metrics().size(), false);
  of_maps.support = false;
  std::vector<ErrorMap> maps = Evaluation(estimate, reference, of_maps, wanted("flip_ldr")).maps();
  std::erase_if(maps, [&](const ErrorMap& map) { return !wanted(map.metric); });
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
    map[p] = std::isfinite(sum) ? sum / 3.0 : kNaN;
  }
  return map;
}

}  // namespace spool
