#include "lib/metrics/pixel_errors.h"

#include <array>
#include <cmath>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/metrics/tone_map.h"

namespace spool {
namespace {

constexpr double kSmallestScale = 0x1p-126;  // mean luminance; as in the analysis
constexpr double kAbsoluteFloor = 1e-2;      // of relmae and smape, after the relative scale

bool is_finite(const RgbImage& image, std::size_t p) {
  return std::isfinite(image[0][p]) && std::isfinite(image[1][p]) && std::isfinite(image[2][p]);
}

double luminance_at(const RgbImage& image, std::size_t p) {
  return luminance(image[0][p], image[1][p], image[2][p]);
}

// Whether a wanted metric is one of those that `belongs` says yes to.
template <class Belongs>
bool wants_one(const MetricOptions& options, const Belongs& belongs) {
  for (std::size_t m = 0; m < metric_list().size(); ++m) {
    if (is_wanted(options, m) && belongs(metric_list()[m])) return true;
  }
  return false;
}

}  // namespace

bool is_wanted(const MetricOptions& options, std::size_t metric) {
  return options.wanted.empty() || options.wanted[metric];
}

bool is_wanted(const MetricOptions& options, std::string_view name) {
  return is_wanted(options, static_cast<std::size_t>(metric_index(name)));
}

WantedTerms wanted_terms(const MetricOptions& options, bool flip_map) {
  const bool perceptual = options.perceptual != Perceptual::kNone;
  WantedTerms wanted;
  wanted.luma = perceptual && (is_wanted(options, "ssim") || is_wanted(options, "ms_ssim"));
  wanted.tone =
      wanted.luma || wants_one(options, [](const Metric& m) { return m.rule == Rule::kDecibel; });
  wanted.flip = perceptual && (flip_map || is_wanted(options, "flip_ldr"));
  wanted.squares = options.support || wants_one(options, [](const Metric& m) {
                     return m.rule == Rule::kEqualEnergy || m.rule == Rule::kEqualDeciles;
                   });
  wanted.deciles = wanted.squares || wants_one(options, [](const Metric& m) {
                     return m.rule == Rule::kRatio && m.numerator >= kDecileEnergy;
                   });
  return wanted;
}

PixelErrors::PixelErrors(const RgbImage& estimate, const JudgingReference& reference,
                         const MetricOptions& options, WantedTerms wanted)
    : estimate_(estimate),
      reference_(reference),
      options_(options),
      wanted_(wanted),
      judged_(estimate[0].width(), estimate[0].height()) {
  select_pixels();
  if (pixels_ == 0) return;
  if (reference.variance && !equals_reference()) variance_ = &*reference.variance;
  choose_scale();
  make_sides();
}

void PixelErrors::select_pixels() {
  for (std::size_t p = 0; p < judged_.size(); ++p) {
    if (!is_finite(estimate_, p)) {
      ++excluded_estimate_;
    } else if (!is_finite(reference_.mean, p) ||
               (reference_.variance && !is_finite(*reference_.variance, p)) ||
               (reference_.denominator && !is_finite(*reference_.denominator, p))) {
      ++excluded_reference_;
    } else {
      judged_[p] = 1;
      ++pixels_;
    }
  }
  guards_.add(Guard::kMetricExcluded, excluded_estimate_ + excluded_reference_);
}

bool PixelErrors::equals_reference() const {
  for (std::size_t p = 0; p < judged_.size(); ++p) {
    for (std::size_t c = 0; judged_[p] && c < 3; ++c)
      if (estimate_[c][p] != reference_.mean[c][p]) return false;
  }
  return true;
}

void PixelErrors::choose_scale() {
  if (options_.rel_scale == RelativeScale::kNone) return;
  const double sum = pairwise_sum(judged_.size(), [&](std::size_t p) {
    return judged_[p] ? luminance_at(reference_.mean, p) : 0.0;
  });
  const double mean = sum / static_cast<double>(pixels_);
  if (std::isfinite(mean) && mean >= kSmallestScale) {
    relative_scale_ = 1.0 / mean;
  } else {
    guards_.add(Guard::kExposureFallback);
  }
}

const RgbImage& PixelErrors::denominator() const {
  return reference_.denominator ? *reference_.denominator : reference_.mean;
}

// What is made of the reference alone, and the tone-mapped estimate.
void PixelErrors::make_sides() {
  const SideParts parts{wanted_.tone, wanted_.flip, wanted_.deciles};
  side_ = reference_.kept ? reference_.kept->of(reference_.mean, denominator(), judged_, parts)
                          : std::make_shared<const ReferenceSide>(
                                reference_side(reference_.mean, denominator(), judged_, parts));
  if (!wanted_.tone) return;
  luma_ = Plane(judged_.width(), judged_.height(), std::numeric_limits<double>::quiet_NaN());
  tone_squared_ = Plane(judged_.width(), judged_.height());
  parallel_rows(0, judged_.height(), [&](int y) {
    for (int x = 0; x < judged_.width(); ++x)
      if (const std::size_t p = judged_.index(x, y); judged_[p]) tone_map_pixel(p);
  });
}

void PixelErrors::tone_map_pixel(std::size_t p) {
  std::array<double, 3> tone;
  for (std::size_t c = 0; c < 3; ++c) {
    tone[c] = tone_mapped(estimate_[c][p], side_->exposure);
    const double difference = tone[c] - side_->tone[c][p];
    tone_squared_[p] += difference * difference / 3.0;
  }
  luma_[p] = luminance(tone[0], tone[1], tone[2]);
}

// What the error of a channel is divided by in relmse, radiance units.
double PixelErrors::divisor(std::size_t c, std::size_t p) const {
  return options_.rel_denominator == RelativeDenominator::kLuminance
             ? luminance_at(denominator(), p)
             : denominator()[c][p];
}
// Of the squared error times the squared relative scale.
double PixelErrors::relative_divisor(std::size_t c, std::size_t p) const {
  const double d = relative_scale_ * divisor(c, p);
  return d * d + options_.rel_eps;
}

PixelTerms PixelErrors::terms(std::size_t p) const {
  PixelTerms terms{};
  terms[kCount] = 1.0;
  const double scale = relative_scale_;
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
    const double plain = divisor(c, p);
    terms[kRelativePlain] += squared / (plain * plain + options_.rel_eps) / 3.0;
    terms[kRelativeOf + c] = relative;
    terms[kAbsolute] += difference / 3.0;
    terms[kRelativeAbsolute] += scale * difference / (scale * std::abs(r) + kAbsoluteFloor) / 3.0;
    terms[kSymmetric] +=
        scale * difference / (scale * (std::abs(i) + std::abs(r)) + kAbsoluteFloor) / 3.0;
    terms[kEnergy] += i;
    terms[kReferenceEnergy] += r;
  }
  if (wanted_.tone) terms[kToneSquared] = tone_squared_[p];
  return terms;
}

void PixelErrors::add_squares(std::size_t p, Terms& sums) const {
  const double scale = relative_scale_;
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

}  // namespace spool
