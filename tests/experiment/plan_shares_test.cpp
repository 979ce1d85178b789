#include "lib/experiment/plan_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace spool {
namespace {

std::vector<Cell> cells_of(int recordings, int samplers, int filters, int replicates) {
  std::vector<std::string> dumps;
  std::vector<MethodChoice> sampling, filtering;
  for (int i = 0; i < recordings; ++i)
    dumps.push_back("r" + std::to_string(i));
  for (int i = 0; i < samplers; ++i)
    sampling.push_back({"s" + std::to_string(i), "", {}});
  for (int i = 0; i < filters; ++i)
    filtering.push_back({"f" + std::to_string(i), "", {}});
  return all_cells(dumps, sampling, filtering, {4, 8, 16}, replicates);
}

std::vector<PlannedRun> costed(const std::vector<Cell>& cells, unsigned seed) {
  std::mt19937 random(seed);
  std::lognormal_distribution<double> cost(0.0, 1.0);
  auto runs = sampling_runs(cells);
  std::map<std::string, double> of_recording;
  for (PlannedRun& run : runs) {
    const double size = of_recording.try_emplace(run.dump, cost(random)).first->second;
    run.cost = size * cost(random);
  }
  return runs;
}

TEST(PlanShares, RunsHoldEveryCellOnceAndOneSetOfSamples) {
  const auto cells = cells_of(2, 3, 4, 2);
  const auto runs = sampling_runs(cells);
  EXPECT_EQ(runs.size(), 2u * 3 * 3 * 2);
  std::set<std::size_t> seen;
  for (const PlannedRun& run : runs) {
    EXPECT_EQ(run.cells.size(), 4u);
    for (const std::size_t i : run.cells) {
      EXPECT_TRUE(seen.insert(i).second);
      EXPECT_EQ(cells[i].sampler, cells[run.cells.front()].sampler);
      EXPECT_EQ(cells[i].spp, cells[run.cells.front()].spp);
      EXPECT_EQ(cells[i].replicate, cells[run.cells.front()].replicate);
      EXPECT_EQ(cells[i].dump, run.dump);
    }
  }
  EXPECT_EQ(seen.size(), cells.size());
}

TEST(PlanShares, TheLargestIsNearTheBestThatIsPossible) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const int shares : {1, 4, 16, 100}) {
      const auto runs = costed(cells_of(1 + static_cast<int>(seed) % 7, 8, 2, 4), seed);
      const auto share_of = balanced_shares(runs, shares);
      std::vector<double> loads(static_cast<std::size_t>(shares), 0.0);
      double total = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < runs.size(); ++i) {
        ASSERT_GE(share_of[i], 0);
        ASSERT_LT(share_of[i], shares);
        loads[static_cast<std::size_t>(share_of[i])] += runs[i].cost;
        total += runs[i].cost;
        largest = std::max(largest, runs[i].cost);
      }
      // Longest first is within 4/3 of the best in any case [Graham69].
      EXPECT_LE(std::ranges::max(loads), 4.0 / 3.0 * std::max(largest, total / shares))
          << "seed " << seed << ", " << shares << " shares";
    }
  }
}

TEST(PlanShares, ARecordingStaysOnFewShares) {
  auto runs = sampling_runs(cells_of(20, 8, 2, 4));
  for (PlannedRun& run : runs)
    run.cost = 1.0;
  const auto share_of = balanced_shares(runs, 10);
  std::map<std::string, std::set<int>> shares_of;
  for (std::size_t i = 0; i < runs.size(); ++i)
    shares_of[runs[i].dump].insert(share_of[i]);
  for (const auto& [dump, shares] : shares_of)
    EXPECT_EQ(shares.size(), 1u) << dump;
}

TEST(PlanShares, MoreSharesThanRunsLeaveSomeEmpty) {
  const auto runs = costed(cells_of(1, 1, 1, 1), 1);
  const auto share_of = balanced_shares(runs, 50);
  EXPECT_EQ(std::set<int>(share_of.begin(), share_of.end()).size(), runs.size());
  EXPECT_TRUE(balanced_shares({}, 3).empty());
}

}  // namespace
}  // namespace spool
