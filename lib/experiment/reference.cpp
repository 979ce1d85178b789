#include "lib/experiment/reference.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "lib/core/option_table.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct SampleRange {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

// Which samples of piece (x, y) make the reference and which the denominator.
struct PieceSplit {
  SampleRange reference, denominator;
};

struct ChannelMoments {
  double mean = 0.0, m2 = 0.0;
};

// The n-th sample.
void take(const Rgb& value, int n, std::array<ChannelMoments, 3>& moments) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double delta = value[c] - moments[c].mean;
    moments[c].mean += delta / n;
    moments[c].m2 += delta * (value[c] - moments[c].mean);
  }
}

// Of every `step`-th sample of the range.
std::array<ChannelMoments, 3> moments(const SamplePool& pool, int x, int y, SampleRange range,
                                      int step = 1) {
  std::array<ChannelMoments, 3> result;
  int n = 0;
  for (int i = range.begin; i < range.end; i += step)
    take(pool.sample(x, y, i), ++n, result);
  return result;
}

// Pixel means (equal weight for the pieces of a pixel) of the samples that `split` names, with
// their unbiased variance; NaN where a piece has too few.
JudgingReference split_reference(const SamplePool& pool,
                                 const std::function<PieceSplit(int, int)>& split) {
  const int q = pool.pieces_per_side();
  const int width = pool.recording().width(), height = pool.recording().height();
  JudgingReference reference{make_rgb(width, height), make_rgb(width, height),
                             make_rgb(width, height)};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      std::array<double, 3> mean{}, variance{}, denominator{};
      for (int piece = 0; piece < q * q; ++piece) {
        const int px = x * q + piece % q, py = y * q + piece / q;
        const PieceSplit ranges = split(px, py);
        const int n = ranges.reference.size();
        const auto judged = moments(pool, px, py, ranges.reference);
        const auto divided = moments(pool, px, py, ranges.denominator);
        for (std::size_t c = 0; c < 3; ++c) {
          mean[c] += n >= 2 ? judged[c].mean / (q * q) : kNaN;
          variance[c] += n >= 2 ? judged[c].m2 / (n - 1) / n / (q * q * q * q) : kNaN;
          denominator[c] += ranges.denominator.size() > 0 ? divided[c].mean / (q * q) : kNaN;
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        reference.mean[c](x, y) = mean[c];
        (*reference.variance)[c](x, y) = variance[c];
        (*reference.denominator)[c](x, y) = denominator[c];
      }
    }
  });
  for (Plane& plane : *reference.denominator)
    plane = box_mean_3x3(plane);
  return reference;
}

// The last third, rounded down but at least one, of a range.
PieceSplit split_third(SampleRange range) {
  if (range.size() < 3) return {range, {}};
  const int cut = range.end - range.size() / 3;
  return {{range.begin, cut}, {cut, range.end}};
}

PieceSplit held_out(const SamplePool& pool, int x, int y) {
  return split_third({pool.capacity(x, y), pool.size(x, y)});
}

// Does it lie, in pixels evenly spread, where the mean of their samples does? Of other samples 2 %
// do, and 10 % of a sequence in order; values without noise say nothing.
bool is_mean_of_its_own(const RecordedSamples& recording, const RgbImage& reference) {
  constexpr std::size_t kLookedAt = 1 << 15, kEnough = 32;  // samples; values with noise
  constexpr double kNear = 0.02, kNoise = 0.0001;  // standard errors; of the mean, beyond rounding
  const auto spp = static_cast<std::size_t>(recording.spp());
  const auto width = static_cast<std::size_t>(recording.width());
  const std::size_t step = 1 + reference[0].size() / (2 * kEnough + kLookedAt / spp);
  std::size_t near = 0, noisy = 0;
  for (std::size_t i = 0; i < reference[0].size(); i += step) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    std::array<ChannelMoments, 3> of;
    int n = 0;
    for (int s = 0; s < recording.spp(); ++s) {
      if (!recording.rejected(x, y, s)) take(recording.radiance(x, y, s), ++n, of);
    }
    for (std::size_t c = 0; n > 1 && c < 3; ++c) {
      const double error = std::sqrt(of[c].m2 / (n - 1) / n);
      if (!(error > kNoise * std::abs(of[c].mean))) continue;
      ++noisy;
      near += std::abs(of[c].mean - reference[c](x, y)) < kNear * error;
    }
  }
  return noisy >= kEnough && static_cast<double>(near) >= 0.99 * static_cast<double>(noisy);
}

}  // namespace

const std::vector<ReferenceDescription>& reference_kinds() {
  static const std::vector<ReferenceDescription> kinds = {
      {ReferenceKind::kIndependent, "independent",
       "the reference in the recording, from samples of its own"},
      {ReferenceKind::kHoldout, "holdout",
       "the last samples of every pixel, which no sampler is offered"},
      {ReferenceKind::kHoldoutPair, "holdout_pair",
       "two means of the held-out samples: their product of errors, without an estimated variance"},
      {ReferenceKind::kLeaveSelectedOut, "leave_selected_out",
       "the samples that the sampler did not select; three of every pixel it is not offered"},
      {ReferenceKind::kCrossfit, "crossfit",
       "each half of every pixel's samples by the other half; the mean of both errors. Budgets up "
       "to "
       "half of the recording"},
      {ReferenceKind::kPool, "pool",
       "the mean of all samples, the selected ones among them: BIASED, for comparison only", true},
  };
  return kinds;
}

std::string_view reference_name(ReferenceKind kind) {
  for (const ReferenceDescription& description : reference_kinds()) {
    if (description.kind == kind) return description.name;
  }
  return "?";
}

Result<ReferenceKind> parse_reference_kind(std::string_view name) {
  for (const ReferenceDescription& description : reference_kinds()) {
    if (description.name == name) return description.kind;
  }
  return fail(ErrorCode::kUsage, "{}",
              unknown_name("reference", name, names_of(reference_kinds())));
}

int default_holdout(int spp) {
  return spp < 32 ? 0 : std::max(16, spp / 4);
}

int withheld_samples(ReferenceKind kind, int spp, std::optional<int> chosen, int pieces_per_side) {
  const bool holds_out = kind == ReferenceKind::kHoldout || kind == ReferenceKind::kHoldoutPair;
  const int asked = chosen.value_or(holds_out ? default_holdout(spp) : 0);
  if (kind != ReferenceKind::kLeaveSelectedOut) return asked;
  const int pieces = pieces_per_side * pieces_per_side;
  return std::max(asked, std::min(kLeastWithheld * pieces, spp - pieces));
}

Result<void> check_can_judge(ReferenceKind kind, const std::string& recording, bool has_reference,
                             int withheld, int pieces_per_side) {
  if (kind == ReferenceKind::kIndependent && !has_reference) {
    return fail(ErrorCode::kData,
                "{}: holds no independent reference: judge by --reference holdout, or record one",
                recording);
  }
  const int least = kind == ReferenceKind::kHoldout       ? 3
                    : kind == ReferenceKind::kHoldoutPair ? 5
                                                          : 0;
  const int pieces = pieces_per_side * pieces_per_side;
  if ((withheld + pieces - 1) / pieces >= least) return {};
  return fail(ErrorCode::kData,
              "{}: {} held-out samples per pixel cannot judge: hold out at least {}", recording,
              withheld, least * pieces);
}

int offered_samples(ReferenceKind kind, int spp, std::optional<int> chosen, int pieces_per_side) {
  const int offered = spp - withheld_samples(kind, spp, chosen, pieces_per_side);
  return kind == ReferenceKind::kCrossfit ? offered / 2 : offered;
}

ReferenceKind default_reference_kind(int spp, bool has_reference) {
  if (has_reference) return ReferenceKind::kIndependent;
  return default_holdout(spp) > 0 ? ReferenceKind::kHoldout : ReferenceKind::kLeaveSelectedOut;
}

Result<JudgingReference> independent_reference(const RecordedSamples& recording) {
  SPOOL_TRY(check_can_judge(ReferenceKind::kIndependent, recording.name(),
                            recording.reference().has_value(), 0, 1));
  const Reference& recorded = *recording.reference();
  if (is_mean_of_its_own(recording, recorded.mean)) {
    return fail(
        ErrorCode::kData,
        "{}: the reference is the mean of the recording's own samples, which judges them too "
        "kindly: judge by --reference holdout, or record one of other samples",
        recording.name());
  }
  return JudgingReference{recorded.mean, recorded.variance_of_mean, std::nullopt};
}

namespace {

Result<void> check_held_out(ReferenceKind kind, const SamplePool& pool) {
  return check_can_judge(kind, pool.recording().name(), pool.recording().reference().has_value(),
                         pool.options().holdout, pool.pieces_per_side());
}

}  // namespace

Result<JudgingReference> holdout_reference(const SamplePool& pool) {
  SPOOL_TRY(check_held_out(ReferenceKind::kHoldout, pool));
  return split_reference(pool, [&](int x, int y) { return held_out(pool, x, y); });
}

Result<JudgingReference> holdout_pair_reference(const SamplePool& pool) {
  SPOOL_TRY(check_held_out(ReferenceKind::kHoldoutPair, pool));
  JudgingReference reference =
      split_reference(pool, [&](int x, int y) { return held_out(pool, x, y); });
  const int q = pool.pieces_per_side();
  parallel_rows(0, reference.mean[0].height(), [&](int y) {
    for (int x = 0; x < reference.mean[0].width(); ++x) {
      std::array<double, 3> first{}, second{};
      for (int piece = 0; piece < q * q; ++piece) {
        const int px = x * q + piece % q, py = y * q + piece / q;
        const SampleRange range = held_out(pool, px, py).reference;
        const auto even = moments(pool, px, py, range, 2);
        const auto odd = moments(pool, px, py, {range.begin + 1, range.end}, 2);
        for (std::size_t c = 0; c < 3; ++c) {
          first[c] += range.size() >= 2 ? even[c].mean / (q * q) : kNaN;
          second[c] += range.size() >= 2 ? odd[c].mean / (q * q) : kNaN;
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double half = 0.5 * (first[c] - second[c]);
        reference.mean[c](x, y) = 0.5 * (first[c] + second[c]);
        (*reference.variance)[c](x, y) = half * half;
      }
    }
  });
  return reference;
}

JudgingReference leave_selected_out_reference(const SamplePool& pool, const CountImage& counts) {
  SPOOL_CHECK_EQ(counts.width(), pool.width());
  SPOOL_CHECK_EQ(counts.height(), pool.height());
  return split_reference(pool, [&](int x, int y) {
    const int capacity = pool.capacity(x, y), size = pool.size(x, y);
    SPOOL_CHECK_LE(counts(x, y), capacity);
    const bool held_out = size - capacity > kLeastWithheld;
    const PieceSplit split = split_third({held_out ? capacity : counts(x, y), size});
    return PieceSplit{{counts(x, y), split.reference.end}, split.denominator};
  });
}

JudgingReference other_half_reference(const SamplePool& other) {
  return split_reference(other, [&](int x, int y) { return split_third({0, other.size(x, y)}); });
}

JudgingReference pool_reference(const SamplePool& pool) {
  const int q = pool.pieces_per_side();
  const int width = pool.recording().width(), height = pool.recording().height();
  JudgingReference reference{make_rgb(width, height), std::nullopt, std::nullopt};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      for (int piece = 0; piece < q * q; ++piece) {
        const int px = x * q + piece % q, py = y * q + piece / q;
        const int n = pool.size(px, py);
        const auto all = moments(pool, px, py, {0, n});
        for (std::size_t c = 0; c < 3; ++c)
          reference.mean[c](x, y) += n > 0 ? all[c].mean / (q * q) : kNaN;
      }
    }
  });
  return reference;
}

Plane box_mean_3x3(const Plane& image) {
  Plane blurred(image.width(), image.height());
  parallel_rows(0, image.height(), [&](int y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rectangle window = intersect({x - 1, y - 1, x + 2, y + 2}, image.bounds());
      double sum = 0.0;
      int n = 0;
      for (int py = window.y0; py < window.y1; ++py) {
        for (int px = window.x0; px < window.x1; ++px) {
          if (!std::isfinite(image(px, py))) continue;
          sum += image(px, py);
          ++n;
        }
      }
      blurred(x, y) = n > 0 ? sum / n : kNaN;
    }
  });
  return blurred;
}

}  // namespace spool
