// What an estimate is judged by: independent samples, samples held out of the replay, or samples
// the sampler did not select. Never the mean of the samples it was made of.
//
// One pixel, N samples of variance s2, the mean of the first n judged by the mean of all N: the
// expected squared error is (s2 / n)(1 - n / N), too small by the factor 1 - n/N, and differently
// for each method. `pool` does that; it exists to show the effect and calls itself biased.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lib/core/error.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/sample_pool.h"

namespace spool {

enum class ReferenceKind {
  kIndependent,
  kHoldout,
  kLeaveSelectedOut,
  kCrossfit,
  kPool,
  kHoldoutPair
};

struct ReferenceDescription {
  ReferenceKind kind;
  std::string name;
  std::string meaning;
  bool biased = false;
};
const std::vector<ReferenceDescription>& reference_kinds();
std::string_view reference_name(ReferenceKind kind);
Result<ReferenceKind> parse_reference_kind(std::string_view name);
inline bool is_biased(ReferenceKind kind) {
  return kind == ReferenceKind::kPool;
}

// Samples per pixel to hold out by default: a quarter, at least 16, and none when the recording is
// too short to spare them (fewer than 32 samples).
int default_holdout(int spp);
// Samples per pixel that a pool holds out for such a reference, where `chosen` are asked for: those
// where given, else the default of a holdout kind. leave_selected_out holds out at least
// kLeastWithheld per piece: a sampler that took all samples of a pixel would drop it from its own
// error, which every method would then do differently. Recordings of fewer offer one per piece, and
// have no such reference.
inline constexpr int kLeastWithheld = 3;  // two for a mean with its variance, one to divide by
int withheld_samples(ReferenceKind kind, int spp, std::optional<int> chosen, int pieces_per_side);
// Error kData where no image can be judged so: without a reference, or by too few held-out samples
// of a pixel. One line before any work, instead of one in each result.
Result<void> check_can_judge(ReferenceKind kind, const std::string& recording, bool has_reference,
                             int withheld, int pieces_per_side);
// What is left of a pixel's samples for a sampler; with crossfit, of a half of them.
int offered_samples(ReferenceKind kind, int spp, std::optional<int> chosen, int pieces_per_side);
// The kind used without a choice: independent where the recording carries a reference, else
// holdout where it can spare the samples, else leave_selected_out.
ReferenceKind default_reference_kind(int spp, bool has_reference);

// The reference recorded with the samples. Error kData when there is none, or it is the mean of
// those samples. Without a recorded variance it is taken as exact.
Result<JudgingReference> independent_reference(const RecordedSamples& recording);

// Means of the held-out samples of the pool: two thirds of them (rounded up) are R, with their
// variance; the 3x3 box mean of the remaining third is the denominator, which must not share noise
// with R. Error kData when the pool holds out fewer than 3 samples per piece.
// A pixel with fewer than two held-out samples in some piece has no reference (NaN).
Result<JudgingReference> holdout_reference(const SamplePool& pool);

// The same samples and denominator, but R is made of two means R1 and R2 of every other sample:
// (E - R1)(E - R2) has the expectation (E - mu)^2 without an estimated variance. With R their mean
// that is (E - R)^2 - ((R1 - R2) / 2)^2, so the second term stands in for the variance: right over
// many pixels, and for one pixel with one degree of freedom only. Errors as above, of 5 samples.
Result<JudgingReference> holdout_pair_reference(const SamplePool& pool);

// Means of the samples that the selection did not take, counts(x, y) per piece: unbiased even when
// the counts depend on the data, since a decision used selected samples only. With a holdout of
// more than kLeastWithheld the denominator is as above and R is made of all other unselected
// samples; else it is the 3x3 box mean of the last third of the unselected samples. A pixel with
// fewer than two samples left in some piece has no reference (NaN): see withheld_samples().
JudgingReference leave_selected_out_reference(const SamplePool& pool, const CountImage& counts);

// Means of all samples of the other half of the recording (SamplePool::half), which had no part in
// an image made of this half; the denominator is as in holdout_reference.
JudgingReference other_half_reference(const SamplePool& other);

// Mean of every recorded sample, as if exact: biased.
JudgingReference pool_reference(const SamplePool& pool);

// 3x3 box mean over the finite pixels of the window, clipped at the border; NaN where there is
// none.
Plane box_mean_3x3(const Plane& image);

}  // namespace spool
