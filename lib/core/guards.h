// Guards: every clamp, floor, epsilon and early-out of the numeric code, by name, with what it
// protects and how often it caught something.
//
// A guard is registered once, in the table below, and counted where it stands. Functions that guard
// take a GuardCounts& (or return one inside their result); parallel loops keep one per row and add
// them up. The counts are printed by the program and never change a result.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace spool {

// SPOOL_GUARDS(X): X(identifier, "name", "what it protects").
#define SPOOL_GUARDS(X)                                                                            \
  X(kRejectedNonFinite, "rejected_non_finite",                                                     \
    "a NaN, infinite or > 1e15 sample is removed from its pool")                                   \
  X(kZeroedNonFinite, "zeroed_non_finite", "a non-finite sample is replaced by zero (option)")     \
  X(kClampedNegative, "clamped_negative", "a negative sample is replaced by zero (option)")        \
  X(kClampedFirefly, "clamped_firefly", "a sample is clamped to the firefly limit (option)")       \
  X(kExposureFallback, "exposure_fallback",                                                        \
    "the exposure scale is 1 because the mean luminance is not finite or below 2^-126")            \
  X(kVarianceFloor, "variance_floor",                                                              \
    "a variance of the mean is raised to (1e-6 (|mean| + 1e-3 key))^2 so that selectors can move") \
  X(kContrastUndefined, "contrast_undefined",                                                      \
    "the literal contrast is 0 because maximum + minimum is below 1e-30")                          \
  X(kPriorityNotFinite, "priority_not_finite", "a non-finite priority is made the largest finite") \
  X(kSaturatedPieces, "saturated_pieces", "a piece ran out of recorded samples")                   \
  X(kUniformRemainder, "uniform_remainder",                                                        \
    "samples spent uniformly because every priority was zero")                                     \
  X(kFeatureNotFinite, "feature_not_finite",                                                       \
    "a feature that is not finite, or beyond 1e15, counts as 0")                                   \
  X(kWantBeyondPool, "want_beyond_pool",                                                           \
    "samples that a command requests beyond what is recorded go to the other pieces it names")     \
  X(kSizeNotFinite, "size_not_finite", "a non-finite size criterion stops at its level")           \
  X(kSizeFactorClamped, "size_factor_clamped", "the factor of eq 9 is clamped to its range")       \
  X(kSizeFactorFallback, "size_factor_fallback",                                                   \
    "the factor of eq 9 is a constant because no attenuation is defined")                          \
  X(kIsotropicFallback, "isotropic_fallback",                                                      \
    "no direction stands out of the noise: the filter is round")                                   \
  X(kNegativeBandEnergy, "negative_band_energy",                                                   \
    "a band's energy fell below its noise and is taken as zero")                                   \
  X(kFilterFloor, "filter_floor", "a standard deviation of the filter is raised to 0.25 pieces")   \
  X(kEmptyPiece, "empty_piece", "a piece without samples takes its neighbours' value")             \
  X(kZeroWeight, "zero_weight", "all weights vanished: the nearest sampled piece is taken")        \
  X(kMetricExcluded, "metric_excluded", "a non-finite pixel is excluded from the metrics")         \
  X(kSmallImage, "small_image",                                                                    \
    "SSIM takes a smaller window or MS-SSIM fewer scales because the image is small")              \
  X(kNegativeError, "negative_error",                                                              \
    "an estimate of a squared error that decides came out negative and is taken as zero")          \
  X(kClampedSample, "clamped_sample",                                                              \
    "a sample is scaled down to what the samples around it allow (option clamp, filter clamped)")  \
  X(kResidualNotFinite, "residual_not_finite",                                                     \
    "a pixel that is not finite takes no part in the returned residual")                           \
  X(kEnergyNotFinite, "energy_not_finite",                                                         \
    "a pixel that is not finite takes no part in the energy step")                                 \
  X(kSparseHalf, "sparse_half",                                                                    \
    "a half has no sample near a pixel: its weight is that of a thousandth of a sample")

enum class Guard : std::size_t {
#define SPOOL_GUARD_ENUM(identifier, name, protects) identifier,
  SPOOL_GUARDS(SPOOL_GUARD_ENUM)
#undef SPOOL_GUARD_ENUM
      kCount
};

inline constexpr std::size_t kGuardCount = static_cast<std::size_t>(Guard::kCount);

std::string_view guard_name(Guard guard);
std::string_view guard_protects(Guard guard);

class GuardCounts {
 public:
  void add(Guard guard, std::uint64_t n = 1) { counts_[static_cast<std::size_t>(guard)] += n; }
  std::uint64_t operator[](Guard guard) const { return counts_[static_cast<std::size_t>(guard)]; }
  GuardCounts& operator+=(const GuardCounts& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i)
      counts_[i] += other.counts_[i];
    return *this;
  }
  friend bool operator==(const GuardCounts&, const GuardCounts&) = default;

 private:
  std::array<std::uint64_t, kGuardCount> counts_{};
};

}  // namespace spool
