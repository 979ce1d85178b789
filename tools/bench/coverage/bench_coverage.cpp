// How often the 95 % intervals of the statistics hold the truth, over many trials on analytic
// scenes.
//
//   bench_coverage [TRIALS [DRAWN]]    rows as JSON; tools/bench/coverage/run.py makes the page of
//   them
//
// Every trial samples, filters and judges five replicates, or twenty where the first column says
// so. The truth is known in closed form for unfiltered fixed counts and is else the mean over all
// trials, which knows it thirty times better than a trial does.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>

#include <nlohmann/json.hpp>

#include "lib/core/check.h"
#include "lib/core/parallel.h"
#include "lib/experiment/reference.h"
#include "lib/filters/filters.h"
#include "lib/inference/budget_curve.h"
#include "lib/inference/comparison.h"
#include "lib/inference/intervals.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "lib/synthetic/scene_s.h"

namespace spool::bench {
namespace {

constexpr int kSide = 64, kBlock = 16;

using Method = std::pair<std::string, std::string>;               // sampler, filter
using Trial = std::map<std::pair<Method, double>, MethodSeries>;  // of mse, by method and budget

struct World {
  std::string drawn;  // what every trial draws anew
  std::vector<Method> methods;
  std::vector<double> spp;
  std::function<std::shared_ptr<const RecordedSamples>(std::uint64_t trial)> record;
  std::uint64_t replicates = 5;
};

// Exponential noise around 1; `contrast` of each block of 16 x 16 pixels scales it.
AnalyticScene noise_scene(std::function<double(int block)> contrast) {
  const auto at = [contrast](int x, int y) {
    return contrast(y / kBlock * (kSide / kBlock) + x / kBlock);
  };
  AnalyticScene scene;
  scene.name = "noise";
  scene.width = scene.height = kSide;
  scene.value = [at](const SampleDraw& draw) {
    const double noise = -std::log(1.0 - draw.t) - 1.0;
    return 1.0 + at(static_cast<int>(draw.x), static_cast<int>(draw.y)) * noise;
  };
  scene.moments = [at](int x, int y) {
    const double a = at(x, y);
    return Moments{1.0, a * a};
  };
  return scene;
}

std::shared_ptr<const RecordedSamples> shared(RecordedSamples recording) {
  return std::make_shared<const RecordedSamples>(std::move(recording));
}

// The value and resamples of `mse`, as error_metrics has them, without its thirty other metrics.
struct SquaredError {
  double value = 0;
  std::vector<double> resampled;
};
SquaredError squared_error(const RgbImage& image, const JudgingReference& reference,
                           const BlockBootstrap& bootstrap) {
  const Plane error = squared_error_map(image, reference);
  std::vector<double> sums(static_cast<std::size_t>(bootstrap.blocks()), 0.0);
  std::vector<double> counts(sums.size(), 0.0);
  for (int y = 0; y < error.height(); ++y) {
    for (int x = 0; x < error.width(); ++x) {
      const auto block = static_cast<std::size_t>(bootstrap.block_of(x, y));
      sums[block] += error(x, y);
      counts[block] += 1.0;
    }
  }
  SquaredError result{weighted_sum(sums, {}) / weighted_sum(counts, {}), {}};
  for (int r = 0; r < bootstrap.resamples(); ++r) {
    result.resampled.push_back(weighted_sum(sums, bootstrap.weights(r)) /
                               weighted_sum(counts, bootstrap.weights(r)));
  }
  return result;
}

template <class Value>
Value or_exit(Result<Value> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "bench_coverage: %s\n", result.error().message.c_str());
  std::exit(1);
}

SamplingContext with_seed(std::uint64_t seed) {
  SamplingContext context;
  context.seed = seed;
  return context;
}

// As an evaluation does it: replicate r shuffles the samples of every pixel by its own seed.
Trial run_trial(const World& world, std::uint64_t trial) {
  const auto recording = world.record(trial);
  const JudgingReference reference = or_exit(independent_reference(*recording));
  const BlockBootstrap bootstrap(recording->width(), recording->height());
  Trial series;
  for (std::uint64_t r = 0; r < world.replicates; ++r) {
    PoolOptions options;
    options.order = PoolOrder::kShuffled;
    options.seed = mix(mix(2024, trial), r);
    const SamplePool pool = or_exit(SamplePool::create(recording, options));
    std::map<std::pair<std::string, double>, Selection> taken;  // filters share a selection
    for (const auto& [sampler, filter] : world.methods) {
      for (const double spp : world.spp) {
        const auto [found, is_new] = taken.try_emplace({sampler, spp});
        if (is_new) {
          found->second =
              or_exit(or_exit(make_method(samplers(), {sampler, "", {}}))(
                          pool, sample_budget(spp, *recording), with_seed(options.seed)))
                  .selection;
        }
        const Reconstruction made = or_exit(or_exit(make_method(filters(), {filter, "", {}}))(
            found->second, pool, FilterContext{}));
        SquaredError error = squared_error(made.image, reference, bootstrap);
        MethodSeries& one = series[{{sampler, filter}, spp}];
        one.blocks = bootstrap.blocks();
        one.values.push_back(error.value);
        one.resampled.push_back(std::move(error.resampled));
        if (trial > 0 || r > 0) continue;
        const MetricTable table = error_metrics(made.image, reference);
        const auto mse = static_cast<std::size_t>(metric_index("mse"));
        SPOOL_CHECK(std::abs(table.values[mse].value - one.values[0]) < 1e-12 * one.values[0]);
        SPOOL_CHECK(std::abs(table.resampled[mse][7] - one.resampled[0][7]) <
                    1e-12 * one.values[0]);
      }
    }
  }
  return series;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value;
  return sum / static_cast<double>(values.size());
}

struct Bounds {
  double low = 0, high = 0;
};

class Table {
 public:
  Table(const World& world, const std::vector<Trial>& trials) : world_(world), trials_(trials) {}

  double truth(const Method& method, double spp) const {
    double sum = 0.0;
    for (const Trial& trial : trials_)
      sum += mean_of(trial.at({method, spp}).values);
    return sum / static_cast<double>(trials_.size());
  }
  // The means over all trials, as one curve without noise.
  BudgetCurve true_curve(const Method& method) const {
    BudgetCurve curve{world_.spp, {}};
    for (const double spp : world_.spp)
      curve.series.push_back({"truth", {truth(method, spp)}, {{}}});
    return curve;
  }
  static BudgetCurve curve(const Trial& trial, const Method& method,
                           const std::vector<double>& spp) {
    BudgetCurve curve{spp, {}};
    for (const double budget : spp)
      curve.series.push_back(trial.at({method, budget}));
    return curve;
  }

  void add(const std::string& interval, const std::string& of, double truth,
           const std::function<Bounds(const Trial&)>& bounds) {
    std::vector<Bounds> found(trials_.size());
    parallel_for(trials_.size(), [&](std::size_t t) { found[t] = bounds(trials_[t]); });
    int covered = 0;
    double width = 0.0;
    for (const Bounds& b : found) {
      covered += b.low <= truth && truth <= b.high;
      width += b.high - b.low;
    }
    rows.push_back({{"drawn", world_.drawn},
                    {"interval", interval},
                    {"of", of},
                    {"truth", truth},
                    {"trials", trials_.size()},
                    {"covered", covered},
                    {"width", width / static_cast<double>(trials_.size())}});
  }

  nlohmann::ordered_json rows = nlohmann::ordered_json::array();

 private:
  const World& world_;
  const std::vector<Trial>& trials_;
};

const Method kBox{"uniform", "box"}, kGaussian{"uniform", "gaussian"},
    kOurs{"multiscale", "directional"};

Bounds of(const Interval& interval) {
  return {interval.low, interval.high};
}

// Intervals over replicates: of one recording, so the truth is that of its orders.
void add_replicate_intervals(Table& table, double spp) {
  for (const Method& method : {kBox, kGaussian, kOurs}) {
    table.add("mean, over replicates", "MSE of " + method.first + " + " + method.second,
              table.truth(method, spp), [&](const Trial& trial) {
                return of(mean_interval(trial.at({method, spp}).values));
              });
  }
  for (const auto& [a, b] : {std::pair{kGaussian, kBox}, std::pair{kOurs, kGaussian}}) {
    table.add("paired, over replicates",
              a.first + " + " + a.second + " less " + b.first + " + " + b.second,
              table.truth(a, spp) - table.truth(b, spp), [&](const Trial& trial) {
                return of(paired_difference(trial.at({a, spp}).values, trial.at({b, spp}).values));
              });
  }
}

// Intervals from pixel blocks and replicates.
void add_block_intervals(Table& table, const World& world, double variance_of_a_sample) {
  const double spp = 4;
  const double exact = variance_of_a_sample / spp;
  table.add("blocks of one image", "MSE of uniform + box", exact, [&](const Trial& trial) {
    MethodSeries one = trial.at({kBox, spp});
    one.values.resize(1);
    one.resampled.resize(1);
    const ResampledMean found = resampled_mean(one);
    const double reach = found.reach() * found.standard_error;
    return Bounds{found.mean - reach, found.mean + reach};
  });
  table.add("blocks and replicates", "MSE of uniform + box", exact, [&](const Trial& trial) {
    const ResampledMean found = resampled_mean(trial.at({kBox, spp}));
    const double reach = found.reach() * found.standard_error;
    return Bounds{found.mean - reach, found.mean + reach};
  });
  table.add("paired, blocks and replicates", "uniform + gaussian less uniform + box",
            table.truth(kGaussian, spp) - exact, [&](const Trial& trial) {
              const PairedComparison found =
                  compare_paired(trial.at({kGaussian, spp}), trial.at({kBox, spp}));
              return Bounds{found.low, found.high};
            });
  table.add("slope of error over budget", "uniform + box", -1.0, [&](const Trial& trial) {
    const ErrorSlope found = error_slope(Table::curve(trial, kBox, world.spp));
    return Bounds{found.low, found.high};
  });
  const double slope = error_slope(table.true_curve(kGaussian)).fit.slope;
  table.add("slope of error over budget", "uniform + gaussian", slope, [&](const Trial& trial) {
    const ErrorSlope found = error_slope(Table::curve(trial, kGaussian, world.spp));
    return Bounds{found.low, found.high};
  });
  // Between measured budgets the curve is a line on logarithmic axes: exact for uniform + box.
  const double target = variance_of_a_sample / 6.0;
  table.add(
      "samples needed", "uniform + box for the error of 6 samples", 6.0, [&](const Trial& trial) {
        const MethodSeries fixed{"target", {target}, {std::vector<double>(200, target)}};
        const SamplesNeeded found = samples_needed(Table::curve(trial, kBox, world.spp), fixed);
        return Bounds{found.low, found.high};
      });
}

}  // namespace
}  // namespace spool::bench

int main(int argc, char** argv) {
  using namespace spool;
  using namespace spool::bench;
  const int trials = argc > 1 ? std::atoi(argv[1]) : 1000;
  const auto uniform01 = [](std::uint64_t a, std::uint64_t b) { return unit_double(mix(a, b)); };

  const auto quiet = shared(make_scene_s(kSide / 2, kSide / 2, 64, 5));
  const auto fireflies = shared(make_scene_s(kSide / 2, kSide / 2, 64, 5, {.fireflies = true}));
  const auto contrast = [&](std::uint64_t trial, int block) {
    return 0.5 + uniform01(mix(77, trial), static_cast<std::uint64_t>(block));
  };
  const std::vector<Method> three = {kBox, kGaussian, kOurs};
  const World quiet_orders{"order", three, {4}, [&](std::uint64_t) { return quiet; }};
  const World orders{"order, with fireflies", three, {4}, [&](std::uint64_t) { return fireflies; }};
  World many_orders = orders;
  many_orders.drawn = "order, with fireflies, 20 replicates";
  many_orders.replicates = 20;
  const World samples{
      "samples, order", {kBox, kGaussian}, {2, 4, 8}, [](std::uint64_t trial) {
        return shared(make_recording(noise_scene([](int) { return 1.0; }), 32, trial));
      }};
  const World pictures{
      "picture, samples, order", samples.methods, samples.spp, [&](std::uint64_t trial) {
        return shared(
            make_recording(noise_scene([&](int b) { return contrast(trial, b); }), 32, trial));
      }};
  nlohmann::ordered_json all = {{"rows", nlohmann::ordered_json::array()}};
  const auto run = [&](const World& world, const auto& fill) {
    if (argc > 2 && world.drawn != argv[2]) return;
    std::vector<Trial> done(static_cast<std::size_t>(trials));
    parallel_for(done.size(), [&](std::size_t t) { done[t] = run_trial(world, t); });
    Table table(world, done);
    fill(table, done);
    for (auto& row : table.rows)
      all["rows"].push_back(std::move(row));
  };
  for (const World* world : {&quiet_orders, &orders, static_cast<const World*>(&many_orders)}) {
    run(*world, [&](Table& table, const std::vector<Trial>& done) {
      add_replicate_intervals(table, 4);
      for (const Trial& trial : done) {
        all["pairs"][world->drawn].push_back(
            {trial.at({kOurs, 4.0}).values, trial.at({kGaussian, 4.0}).values});
      }
    });
  }
  run(samples, [&](Table& table, const auto&) { add_block_intervals(table, samples, 1.0); });
  // E a^2 of a uniform in 0.5 .. 1.5.
  run(pictures,
      [&](Table& table, const auto&) { add_block_intervals(table, pictures, 13.0 / 12.0); });
  std::printf("%s\n", all.dump(1).c_str());
  return 0;
}
