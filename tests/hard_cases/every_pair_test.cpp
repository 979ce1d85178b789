// Every sampler and every filter on every hard case.
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lib/metrics/error_metrics.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/joined_halves.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

using test::HardCase;

// Not weighted means of samples: a band or a sample that is made smaller, or a slope that is
// fitted, may leave their range.
bool stays_between_its_samples(const std::string& filter) {
  return filter != "wavelet_shrinkage" && filter != "twin_guides" && filter != "clamped";
}

template <class Outcome>
void expect_refused_for_features(const Outcome& outcome, const std::string& who) {
  ASSERT_FALSE(outcome.has_value()) << who << ": worked without features";
  EXPECT_EQ(outcome.error().code, ErrorCode::kData) << who;
  EXPECT_THAT(outcome.error().message, ::testing::HasSubstr("needs albedo, normal or depth"))
      << who;
}

class EveryHardCase : public ::testing::TestWithParam<HardCase> {};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Range range_of_taken(const SamplePool& pool, const CountImage& n, std::size_t c) {
  Range range;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      for (int i = 0; i < n(x, y); ++i) {
        const double v = pool.sample(x, y, i)[c];
        range.low = std::min(range.low, v), range.high = std::max(range.high, v);
      }
    }
  }
  return range;
}

// Units in the last place within which a constant picture comes out constant.
double units_for_constants(const std::string& filter) {
  // Sums over hundreds of taps, divided by the sum of the taps.
  const bool many = filter == "greedy_selection" || filter == "oracle_scale" ||
                    filter == "cross_bilateral" || filter == "welch" || filter == "stater";
  return many ? 16 : 4;
}

// Statistics keep the promise of Welford's recurrence: mean inside the samples, no negative square.
void expect_sound_statistics(const SamplePool& pool, const PieceStatistics& s,
                             const std::string& who) {
  for (int y = 0; y < s.height(); ++y) {
    for (int x = 0; x < s.width(); ++x) {
      const std::size_t p = s.n.index(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        long double sum = 0, squares = 0, size = 0;
        for (int i = 0; i < s.n[p]; ++i) {
          sum += pool.sample(x, y, i)[c];
          size = std::max(size, std::abs(static_cast<long double>(pool.sample(x, y, i)[c])));
        }
        const long double mean = s.n[p] > 0 ? sum / s.n[p] : 0;
        for (int i = 0; i < s.n[p]; ++i) {
          const long double d = pool.sample(x, y, i)[c] - mean;
          squares += d * d;
        }
        const long double unit = std::numeric_limits<double>::epsilon() * (s.n[p] + 1.0L);
        ASSERT_LE(std::abs(s.mean[c][p] - mean), unit * size) << who << " " << x << "," << y;
        ASSERT_GE(s.m2[c][p], 0.0) << who << " " << x << "," << y;
        // [ChanGolubLeVeque83]: relative error of Welford's M2 is n eps kappa, kappa = |x| / sigma.
        const long double bound = unit * (squares + std::sqrt(squares * s.n[p]) * size) +
                                  s.n[p] * unit * unit * size * size;
        ASSERT_LE(std::abs(s.m2[c][p] - squares), bound) << who << " " << x << "," << y;
      }
    }
  }
}

void expect_sound_selection(const SamplePool& pool, long long budget, const SamplingResult& result,
                            const std::string& who) {
  const CountImage& n = result.selection.statistics.n;
  const long long possible = std::min(budget, pool.total_capacity());
  EXPECT_EQ(test::total(n), possible) << who;
  EXPECT_EQ(result.log.spent, possible) << who;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      ASSERT_TRUE(n(x, y) >= 0 && n(x, y) <= pool.capacity(x, y)) << who << " " << x << "," << y;
  }
  EXPECT_EQ(result.log.guards[Guard::kSaturatedPieces],
            static_cast<std::uint64_t>(count_saturated(pool, n)))
      << who;
  for (const Plane& a : result.selection.attenuation) {
    for (const double value : a.pixels())
      ASSERT_TRUE(std::isfinite(value) && value >= 0.0) << who;
  }
}

void expect_sound_image(const HardCase& hard, const SamplePool& pool, const Selection& selection,
                        const test::NamedMethod<FilterFunction>& filter, const Reference& reference,
                        const std::string& who) {
  FilterContext context;
  context.reference = &reference;
  const auto result = filter.run(selection, pool, context);
  if (test::total(selection.statistics.n) == 0) {
    ASSERT_FALSE(result.has_value()) << who << ": an image of no sample";
    EXPECT_EQ(result.error().code, ErrorCode::kData) << who;
    return;
  }
  if (hard.featureless && filter.run.needs.features == Use::kRequired) {
    expect_refused_for_features(result, who);
    return;
  }
  ASSERT_TRUE(result.has_value()) << who << ": " << result.error().message;
  for (std::size_t c = 0; c < 3; ++c) {
    const Plane& image = result->image[c];
    ASSERT_EQ(image.width(), pool.recording().width()) << who;
    ASSERT_EQ(image.height(), pool.recording().height()) << who;
    const Range range = range_of_taken(pool, selection.statistics.n, c);
    const double slack = 1e-12 * std::max(std::abs(range.low), std::abs(range.high));
    for (const double v : image.pixels()) {
      ASSERT_TRUE(std::isfinite(v)) << who;
      if (hard.value) {
        // Black stays black to the bit, other constants to a few units in the last place.
        const double ulps = units_for_constants(filter.name) *
                            std::numeric_limits<double>::epsilon() * std::abs(*hard.value);
        ASSERT_NEAR(v, *hard.value, stays_between_its_samples(filter.name) ? ulps : slack) << who;
      } else if (stays_between_its_samples(filter.name)) {
        ASSERT_TRUE(v >= range.low - slack && v <= range.high + slack)
            << who << ": " << v << " outside " << range.low << " .. " << range.high;
      }
    }
    if (!result->variance) continue;
    for (const double v : (*result->variance)[c].pixels())
      ASSERT_TRUE(std::isfinite(v) && v >= 0.0) << who << ": variance " << v;
  }
  if (result->level) {
    for (const auto k : result->level->pixels())
      ASSERT_GE(k, 0) << who;
  }
  MetricOptions quick;
  quick.perceptual = Perceptual::kNone;
  quick.bootstrap.resamples = 20;
  const MetricTable table = error_metrics(result->image, {reference.mean, {}, {}}, quick);
  EXPECT_FALSE(table.failed) << who;
  EXPECT_EQ(table.excluded_estimate, 0u) << who;
}

TEST_P(EveryHardCase, EveryPairOfMethodsKeepsItsPromise) {
  const HardCase& hard = GetParam();
  const SamplePool pool = hard.pool();
  const Reference reference = test::mean_of_everything(pool);
  const bool whole = test::whole_hard_cases();
  const auto samplers = test::every_sampler(!whole || hard.heavy);
  const auto filters = test::every_filter(!whole || hard.heavy);
  for (const double spp : hard.spp) {
    const long long budget = sample_budget(spp, pool.recording());
    for (std::size_t s = 0; s < samplers.size(); ++s) {
      const std::string with =
          hard.name + ", " + std::to_string(spp) + " spp, " + samplers[s].label();
      const auto sampled = samplers[s].run(pool, budget, test::sampling_context());
      if (hard.featureless && samplers[s].run.needs.features == Use::kRequired) {
        expect_refused_for_features(sampled, with);
        continue;
      }
      ASSERT_TRUE(sampled.has_value()) << with << ": " << sampled.error().message;
      expect_sound_selection(pool, budget, *sampled, with);
      const std::vector<Selection>& halves = sampled->selection.halves;
      for (std::size_t h = 0; h < halves.size(); ++h)
        expect_sound_statistics(pool.half(static_cast<int>(h)), halves[h].statistics, with);
      if (halves.empty()) expect_sound_statistics(pool, sampled->selection.statistics, with);
      const SamplePool taken = halves.empty() ? pool : pool_of_joined(pool, sampled->selection);
      for (std::size_t r = 0; r < filters.size(); ++r) {
        // Without `whole`, every filter sees the first sampler and one other.
        if (!whole && s != 0 && s != 1 + r % (samplers.size() - 1)) continue;
        if (!whole && s != 0 && spp != hard.spp.back()) continue;
        expect_sound_image(hard, taken, sampled->selection, filters[r], reference,
                           with + " + " + filters[r].label());
        if (HasFatalFailure()) return;
      }
      if (HasFatalFailure()) return;
    }
  }
}

std::string case_name(const ::testing::TestParamInfo<HardCase>& info) {
  std::string name = info.param.name;
  for (char& letter : name) {
    if (letter == '-') letter = 'm';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Table, EveryHardCase, ::testing::ValuesIn(test::hard_cases()), case_name);

}  // namespace
}  // namespace spool
