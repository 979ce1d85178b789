// How often 95 % intervals hold what another recording of the scene would give, over many
// recordings of one distribution.
//
//   bench_coverage [TRIALS [WORLD]]    JSON; tools/bench/coverage/run.py makes the page of it
//
// Every trial makes a recording of 64 samples per pixel and evaluates it by the runner that `spool
// evaluate` uses, with the replicates of its default and, at 16 samples, as it was done before:
// replicates that each shuffle the same samples, and Student's interval of their mean. The truth is
// the mean over all trials, which knows it as many times better as the root of their number.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "lib/core/parallel.h"
#include "lib/inference/ranking.h"
#include "tools/bench/coverage/trials.h"

namespace spool::bench {
namespace {

using nlohmann::ordered_json;

constexpr int kSide = 16, kSamples = 64;  // pixels a side; samples of a pixel

const std::vector<std::pair<std::string, std::string>> kMethods = {
    {"uniform", "box"}, {"multiscale", "box"}, {"multiscale", "directional"}};

std::string name_of(std::size_t method) {
  return kMethods[method].first + " + " + kMethods[method].second;
}

struct Found {
  double estimate = 0, low = 0, high = 0;
  double standard_error = 0;
};

// One row: how often intervals hold the mean of all estimates.
ordered_json row(const std::string& interval, const std::string& of, double spp,
                 const std::vector<Found>& found) {
  double truth = 0.0;
  for (const Found& one : found)
    truth += one.estimate / static_cast<double>(found.size());
  int covered = 0;
  double spread = 0.0, width = 0.0, error = 0.0;
  for (const Found& one : found) {
    covered += one.low <= truth && truth <= one.high;
    spread += (one.estimate - truth) * (one.estimate - truth);
    width += (one.high - one.low) / static_cast<double>(found.size());
    error += one.standard_error * one.standard_error;
  }
  return {{"interval", interval}, {"of", of},
          {"spp", spp},           {"trials", found.size()},
          {"covered", covered},   {"truth", truth},
          {"width", width},       {"spread_over_error", std::sqrt(spread / error)}};
}

Found of_mean(const Series& series, bool logarithmic) {
  const Interval found = mean_interval(series, logarithmic ? Range::kPositive : Range::kReal);
  if (!logarithmic) return {found.mean, found.low, found.high, found.standard_error};
  return {std::log(found.mean), std::log(found.low), std::log(found.high), found.standard_error};
}

Found of_ratio(const Series& a, const Series& b) {
  const Comparison found = compare_paired(a, b, Better::kLower);
  return {found.difference, found.low, found.high, found.standard_error};
}

Found of_difference(const Series& a, const Series& b) {
  Series difference;
  for (std::size_t r = 0; r < a.values.size(); ++r)
    difference.values.push_back(a.values[r] - b.values[r]);
  return of_mean(difference, false);
}

template <class Measure>
std::vector<Found> over(const std::vector<Trial>& trials, Measure&& measure) {
  std::vector<Found> found;
  for (const Trial& trial : trials)
    found.push_back(measure(trial));
  return found;
}

void add_today(ordered_json& rows, const std::vector<Trial>& trials, std::size_t budget,
               double spp) {
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    rows.push_back(row("mean", name_of(m), spp, over(trials, [&](const Trial& trial) {
                         return of_mean(trial[m][budget], true);
                       })));
  }
  for (std::size_t m = 1; m < kMethods.size(); ++m) {
    rows.push_back(
        row("ratio", name_of(m) + " / " + name_of(0), spp, over(trials, [&](const Trial& trial) {
              return of_ratio(trial[m][budget], trial[0][budget]);
            })));
  }
  rows.push_back(
      row("ratio", name_of(2) + " / " + name_of(1), spp, over(trials, [&](const Trial& trial) {
            return of_ratio(trial[2][budget], trial[1][budget]);
          })));
}

void add_before(ordered_json& rows, const std::vector<Trial>& trials, double spp) {
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    rows.push_back(
        row("before: mean over orders", name_of(m), spp, over(trials, [&](const Trial& trial) {
              return of_mean(Series{trial[m][0].values}, false);
            })));
  }
  rows.push_back(row(
      "before: difference over orders", name_of(2) + " less " + name_of(0), spp,
      over(trials, [&](const Trial& trial) { return of_difference(trial[2][0], trial[0][0]); })));
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    rows.push_back(
        row("shuffled, widened: mean", name_of(m), spp,
            over(trials, [&](const Trial& trial) { return of_mean(trial[m][0], true); })));
  }
}

// Verdicts of all pairs together: right, wrong way round, none. And false ones: the same method on
// two recordings, paired by replicate.
void add_verdicts(ordered_json& rows, const std::vector<Trial>& trials, std::size_t budget,
                  double spp) {
  int decided = 0, wrong = 0, false_claims = 0, nulls = 0;
  std::vector<std::vector<double>> truth(1, std::vector<double>(kMethods.size(), 0.0));
  for (const Trial& trial : trials) {
    for (std::size_t m = 0; m < kMethods.size(); ++m)
      truth[0][m] += of_mean(trial[m][budget], true).estimate;
  }
  for (std::size_t t = 0; t < trials.size(); ++t) {
    std::vector<Series> methods;
    for (std::size_t m = 0; m < kMethods.size(); ++m)
      methods.push_back(trials[t][m][budget]);
    for (const PairVerdict& pair : rank_methods(methods, Better::kLower).pairs) {
      if (pair.verdict == Verdict::kUndecided) continue;
      ++decided;
      wrong += (pair.verdict == Verdict::kBetter) != (truth[0][pair.a] < truth[0][pair.b]);
    }
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      const Comparison same = compare_paired(
          trials[t][m][budget], trials[(t + 1) % trials.size()][m][budget], Better::kLower);
      false_claims += same.p < 0.05;
      ++nulls;
    }
  }
  rows.push_back({{"spp", spp},
                  {"pairs", 3 * trials.size()},
                  {"decided", decided},
                  {"wrong", wrong},
                  {"nulls", nulls},
                  {"false", false_claims}});
}

}  // namespace
}  // namespace spool::bench

int main(int argc, char** argv) {
  using namespace spool;
  using namespace spool::bench;
  const auto trials = static_cast<std::size_t>(argc > 1 ? std::atoi(argv[1]) : 1000);
  const std::string only = argc > 2 ? argv[2] : "";
  const std::string tiny = SPOOL_SOURCE_DIR "/dumps/tiny/";
  const World worlds[] = {
      scene_s_world(kSide, kSamples, false), scene_s_world(kSide, kSamples, true),
      resampled_world(tiny + "chess.spool", 24, 24, kSide, kSamples),
      resampled_world(tiny + "mist.spool", 24, 24, kSide, kSamples), heavy_world(kSide, kSamples)};
  nlohmann::ordered_json all = {{"side", kSide}, {"worlds", nlohmann::ordered_json::array()}};
  for (const World& world : worlds) {
    if (!only.empty() && world.name.find(only) == std::string::npos) continue;
    nlohmann::ordered_json one = {{"world", world.name},
                                  {"rows", nlohmann::ordered_json::array()},
                                  {"verdicts", nlohmann::ordered_json::array()}};
    const auto run = [&](const Protocol& protocol) {
      std::vector<Trial> done(trials);
      parallel_for(trials, [&](std::size_t t) { done[t] = run_trial(world, protocol, t); });
      return done;
    };
    const Protocol today{kMethods, {4, 8, 16}};
    const std::vector<Trial> done = run(today);
    for (std::size_t b = 0; b < today.spp.size(); ++b) {
      add_today(one["rows"], done, b, today.spp[b]);
      add_verdicts(one["verdicts"], done, b, today.spp[b]);
    }
    const Protocol before{kMethods, {16}, 5, ReplicateOrder::kShuffled};
    add_before(one["rows"], run(before), 16);
    all["worlds"].push_back(std::move(one));
  }
  std::printf("%s\n", all.dump(1).c_str());
  return 0;
}
