// The errors of each pixel of an estimate, as the terms that metrics are sums of (metric_list.h):
// which pixels are judged, the scale of relative errors, and what is made of the reference alone.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/metrics/judging_reference.h"
#include "lib/metrics/metric_list.h"
#include "lib/metrics/metric_options.h"
#include "lib/metrics/reference_side.h"

namespace spool {

// Which terms the wanted metrics are made of.
struct WantedTerms {
  bool tone = false;     // of tone-mapped pixels
  bool luma = false;     // their luminance, for structural similarity
  bool flip = false;     // the reference's side of FLIP
  bool deciles = false;  // energies of the deciles of brightness
  bool squares = false;  // squared errors of the deciles, with the image scaled
};

// `flip_map`: the map of FLIP is asked for, whatever metrics are wanted.
WantedTerms wanted_terms(const MetricOptions& options, bool flip_map);

// Whether `options` ask for a metric, by its place in metrics() or its name, which must exist.
bool is_wanted(const MetricOptions& options, std::size_t metric);
bool is_wanted(const MetricOptions& options, std::string_view name);

class PixelErrors {
 public:
  // Images and options are looked at as long as this lives.
  PixelErrors(const RgbImage& estimate, const JudgingReference& reference,
              const MetricOptions& options, WantedTerms wanted);

  const RgbImage& estimate() const { return estimate_; }
  const MetricOptions& options() const { return options_; }
  const WantedTerms& wanted() const { return wanted_; }
  // 1: finite in the estimate and in all that judges it.
  const Image<std::uint8_t>& judged() const { return judged_; }
  std::uint64_t pixels() const { return pixels_; }  // that are judged
  std::uint64_t excluded_estimate() const { return excluded_estimate_; }
  std::uint64_t excluded_reference() const { return excluded_reference_; }
  const GuardCounts& guards() const { return guards_; }

  // The rest is there where pixels are judged.
  double relative_scale() const { return relative_scale_; }
  bool is_debiased() const { return variance_ != nullptr; }
  const ReferenceSide& side() const { return *side_; }
  // Of the tone-mapped estimate, NaN where not judged; empty where it is not wanted.
  const Plane& luma() const { return luma_; }

  PixelTerms terms(std::size_t p) const;
  // Adds what pixel p has of kDecileSquares and kDecileRelativeSquares.
  void add_squares(std::size_t p, Terms& sums) const;

 private:
  void select_pixels();
  bool equals_reference() const;
  void choose_scale();
  void make_sides();
  void tone_map_pixel(std::size_t p);
  const RgbImage& denominator() const;
  double divisor(std::size_t c, std::size_t p) const;
  double relative_divisor(std::size_t c, std::size_t p) const;

  const RgbImage& estimate_;
  const JudgingReference& reference_;
  const RgbImage* variance_ = nullptr;  // b, where it is subtracted
  const MetricOptions& options_;
  const WantedTerms wanted_;
  Image<std::uint8_t> judged_;
  std::uint64_t pixels_ = 0, excluded_estimate_ = 0, excluded_reference_ = 0;
  double relative_scale_ = 1.0;
  GuardCounts guards_;
  std::shared_ptr<const ReferenceSide> side_;
  Plane luma_, tone_squared_;  // of the tone-mapped estimate
};

}  // namespace spool
