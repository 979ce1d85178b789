#include "lib/sampling/asked_counts.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/sampling/multiscale_cases.h"

namespace spool {
namespace {

TEST(GrantWants, SpendsWhatIsWantedAndNothingElsewhere) {
  const int width = 9, height = 7, spp = 12;
  const SamplePool pool = test::noisy_pool(width, height, spp);
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    CountImage n(width, height), wanted(width, height);
    long long wants = 0, room = 0, beyond = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      n[i] = static_cast<std::int32_t>(mix(trial, 1, i) % (spp + 1));
      if (mix(trial, 2, i) % 3 > 0) {
        wanted[i] = static_cast<std::int32_t>(mix(trial, 3, i) % (trial % 2 ? 30 : 6));
      }
      wants += wanted[i];
      if (wanted[i] > 0) room += spp - n[i];
      beyond += std::max(0, wanted[i] - (spp - n[i]));
    }
    const auto left = static_cast<long long>(mix(trial, 4) % 800);
    GuardCounts guards;
    const CountImage granted = grant_wants(wanted, n, pool, left, guards);
    EXPECT_EQ(test::total(granted), std::min({wants, left, room})) << trial;
    EXPECT_EQ(guards[Guard::kWantBeyondPool], static_cast<std::uint64_t>(beyond));
    for (std::size_t i = 0; i < n.size(); ++i) {
      ASSERT_TRUE(granted[i] >= 0 && n[i] + granted[i] <= spp);
      ASSERT_TRUE(wanted[i] > 0 || granted[i] == 0);
      ASSERT_TRUE(wants > left || granted[i] >= std::min(wanted[i], spp - n[i]));
    }
    EXPECT_TRUE(wants > left || beyond > 0 || granted == wanted);
  }
}

TEST(AskedCounts, AsksWhileThereIsBudgetAndStopsAtZeros) {
  const SamplePool pool = test::noisy_pool(6, 5, 16);
  std::vector<long long> lefts;
  const auto ask = [&](int each, int rounds_of_wants) {
    return [=, &lefts](const CountQuestion& question) -> Result<CountImage> {
      lefts.push_back(question.left);
      EXPECT_EQ(question.share, (question.left + question.rounds - question.round - 1) /
                                    (question.rounds - question.round));
      return CountImage(6, 5, question.round < rounds_of_wants ? each : 0);
    };
  };
  AskedCountsOptions options;
  options.init_spp = 2;
  auto result = sample_asked_counts(pool, 30 * 8, options, ask(4, 9), {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 30 * 8);
  EXPECT_EQ(lefts, (std::vector<long long>{180, 60}));
  EXPECT_EQ(result->selection.statistics.n, CountImage(6, 5, 8));

  lefts.clear();
  result = sample_asked_counts(pool, 30 * 8, options, ask(1, 1), {});
  EXPECT_EQ(result->log.spent, 30 * 3);  // the rest is reported, not spent
  EXPECT_EQ(lefts.size(), 2u);

  const auto wrong = sample_asked_counts(
      pool, 30 * 8, options,
      [](const CountQuestion&) -> Result<CountImage> { return CountImage(5, 6, 1); }, {});
  EXPECT_EQ(wrong.error().code, ErrorCode::kData);
}

}  // namespace
}  // namespace spool
