#include "lib/experiment/run_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/experiment/result_record.h"
#include "lib/experiment/result_table.h"
#include "lib/synthetic/scene_s.h"

namespace spool {
namespace {

// Methods for these tests: `uniform` takes samples everywhere, `broken` fails; `mean` gives pixel
// means, `zero` black, `nan` an image that is not finite.
struct Laboratory {
  int loads = 0;
  std::map<std::string, int> sampled;  // runs by sampler
  std::mutex counting;                 // of them

  ExperimentSources sources() {
    return {[this](const std::string& name) -> Result<std::shared_ptr<const RecordedSamples>> {
              ++loads;
              if (name == "absent") return fail(ErrorCode::kIo, "absent: no such file");
              return std::make_shared<const RecordedSamples>(
                  make_scene_s(40, 30, 48, name == "other" ? 2 : 1));
            },
            [this](const MethodChoice& choice) { return sampler(choice); },
            [](const MethodChoice& choice) { return filter(choice); }};
  }

  Result<ReadySampler> sampler(const MethodChoice& choice) {
    const SamplerFunction run = [this, choice](const SamplePool& pool, long long budget,
                                               const SamplingContext&) -> Result<SamplingResult> {
      {
        const std::lock_guard lock(counting);
        ++sampled[choice.name];
      }
      if (choice.name == "broken") return fail(ErrorCode::kData, "broken on purpose");
      SamplingResult result;
      result.selection.statistics = empty_statistics(pool);
      const long long pieces = static_cast<long long>(pool.width()) * pool.height();
      result.log.budget = budget;
      result.log.spent =
          take_everywhere(result.selection.statistics, pool, static_cast<int>(budget / pieces));
      return result;
    };
    return ReadySampler{run, {.filter_in_loop = choice.name == "by_filter"}};
  }

  static Result<ReadyFilter> filter(const MethodChoice& choice) {
    if (choice.name == "unknown") return fail(ErrorCode::kUsage, "unknown filter 'unknown'");
    const FilterFunction run = [choice](const Selection& selection, const SamplePool&,
                                        const FilterContext&) -> Result<Reconstruction> {
      Reconstruction result;
      result.image = pixel_means(selection.statistics, result.guards);
      if (choice.name == "zero") result.image = make_rgb(40, 30);
      if (choice.name == "nan") result.image[0](0, 0) = std::nan("");
      return result;
    };
    return ReadyFilter{run, {}};
  }
};

MethodChoice method(const std::string& name) {
  return {name, "", {}};
}

// Results in the order of `cells`; shorter (finished cells only) when cancelled.
std::vector<CellResult> run_experiment(const std::vector<Cell>& cells,
                                       const ExperimentOptions& options,
                                       const ExperimentSources& sources,
                                       ExperimentCallbacks callbacks = {}) {
  std::vector<std::optional<CellResult>> results(cells.size());
  const auto finished = callbacks.finished;
  callbacks.finished = [&](CellResult& result, const CellImages* images) {
    if (finished) finished(result, images);
    const auto at = std::ranges::find(cells, result.cell) - cells.begin();
    results[static_cast<std::size_t>(at)] = result;
  };
  run_cells(cells, options, sources, callbacks);
  std::vector<CellResult> in_order;
  for (std::optional<CellResult>& result : results) {
    if (result) in_order.push_back(std::move(*result));
  }
  return in_order;
}

std::string value_of(const CellResult& result, const std::string& column) {
  for (const ResultColumn& c : result_columns()) {
    if (c.name == column) return c.text(result);
  }
  return "no such column";
}

TEST(Experiment, AllCellsAreEveryCombination) {
  const auto cells = all_cells({"a", "b"}, {method("s")}, {method("f"), method("g")}, {4, 8}, 3);
  EXPECT_EQ(cells.size(), 2u * 1 * 2 * 2 * 3);
  EXPECT_EQ(cells[0].filter.name, "f");
  EXPECT_EQ(cells[1].filter.name, "g");
  EXPECT_EQ(cells[2].replicate, 1);
}

TEST(Experiment, FiltersOfOneSamplingRunShareItAndRecordingsAreLoadedOnce) {
  Laboratory laboratory;
  auto cells =
      all_cells({"one", "other"}, {method("uniform")}, {method("mean"), method("zero")}, {4, 8}, 2);
  std::swap(cells[0], cells[9]);  // any order
  std::swap(cells[3], cells[14]);
  const auto results = run_experiment(cells, {}, laboratory.sources());
  EXPECT_EQ(laboratory.loads, 2);
  EXPECT_EQ(laboratory.sampled["uniform"], 2 * 2 * 2);
  ASSERT_EQ(results.size(), cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    EXPECT_EQ(results[i].cell, cells[i]);
}

TEST(Experiment, MeasuresTheErrorOfUniformSampling) {
  Laboratory laboratory;
  const auto results = run_experiment(
      all_cells({"one"}, {method("uniform")}, {method("mean")}, {8}, 6), {}, laboratory.sources());
  const ExactImage exact = exact_image(scene_s(40, 30));
  double expected = 0.0;
  for (const double v : exact.sample_variance[0].pixels())
    expected += v / 8 / 1200;
  double sum = 0.0;
  for (const CellResult& result : results) {
    EXPECT_FALSE(result.error.has_value());
    EXPECT_EQ(result.log.spent, 8 * 1200);
    EXPECT_EQ(result.reference, ReferenceKind::kIndependent);
    sum += result.metrics["mse"].value / 6;
  }
  EXPECT_NEAR(sum / expected, 1.0, 0.15);
  EXPECT_NE(results[0].metrics["mse"].value, results[1].metrics["mse"].value);
}

TEST(Experiment, EveryReferenceKindFindsTheSameErrorExceptThePool) {
  double mse[6] = {};
  for (const ReferenceKind kind :
       {ReferenceKind::kIndependent, ReferenceKind::kHoldout, ReferenceKind::kLeaveSelectedOut,
        ReferenceKind::kCrossfit, ReferenceKind::kPool, ReferenceKind::kHoldoutPair}) {
    Laboratory laboratory;
    ExperimentOptions options;
    options.reference = kind;
    // Eight independent orders, which the bounds below are for; the ring has a test of its own.
    options.order = ReplicateOrder::kShuffled;
    const auto results =
        run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {16}, 8), options,
                       laboratory.sources());
    for (const CellResult& result : results) {
      ASSERT_FALSE(result.error.has_value()) << result.error->message;
      mse[static_cast<int>(kind)] += result.metrics["mse"].value / 8;
      const bool holds_out = kind == ReferenceKind::kHoldout || kind == ReferenceKind::kHoldoutPair;
      const int left = kind == ReferenceKind::kLeaveSelectedOut ? kLeastWithheld : 0;
      EXPECT_EQ(result.holdout, holds_out ? 16 : left);
      EXPECT_EQ(value_of(result, "reference"),
                kind == ReferenceKind::kPool ? "pool (biased)" : reference_name(kind));
    }
  }
  EXPECT_NEAR(mse[1] / mse[0], 1.0, 0.15);
  EXPECT_NEAR(mse[2] / mse[0], 1.0, 0.15);
  EXPECT_NEAR(mse[3] / mse[0], 1.0, 0.15);
  EXPECT_NEAR(mse[5] / mse[0], 1.0, 0.15);
  EXPECT_NEAR(mse[4] / mse[0], 1.0 - 16.0 / 48, 0.1);
}

// A method that takes all it is offered is judged by every pixel.
TEST(Experiment, LeaveSelectedOutDropsNoPixel) {
  for (const std::optional<int> holdout : {std::optional<int>(), std::optional(2)}) {
    Laboratory laboratory;
    ExperimentOptions options;
    options.reference = ReferenceKind::kLeaveSelectedOut;
    options.holdout = holdout;
    for (const CellResult& result :
         run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {16, 48}, 1),
                        options, laboratory.sources())) {
      EXPECT_EQ(result.metrics.excluded_reference, 0u);
      EXPECT_EQ(result.metrics.pixels, 40u * 30);
    }
  }
}

// On the ring replicates share samples and held-out samples, so that one picture's ratio has a
// standard deviation of 0.04 (leave_selected_out) to 0.08: the mean over 12 orders of the ring has
// 0.024 at most.
TEST(Experiment, EveryReferenceKindFindsTheSameErrorOnTheRing) {
  const int orders = 12;
  double ratio[6] = {};
  for (int seed = 0; seed < orders; ++seed) {
    double mse[6] = {};
    for (const ReferenceKind kind :
         {ReferenceKind::kIndependent, ReferenceKind::kHoldout, ReferenceKind::kLeaveSelectedOut,
          ReferenceKind::kCrossfit, ReferenceKind::kHoldoutPair}) {
      Laboratory laboratory;
      ExperimentOptions options;
      options.reference = kind;
      options.seed = static_cast<std::uint64_t>(seed);
      for (const CellResult& result :
           run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {16}, 8),
                          options, laboratory.sources()))
        mse[static_cast<int>(kind)] += result.metrics["mse"].value / 8;
      ratio[static_cast<int>(kind)] += mse[static_cast<int>(kind)] / mse[0] / orders;
    }
  }
  for (const int kind : {1, 2, 3, 5})
    EXPECT_NEAR(ratio[kind], 1.0, 0.08) << kind;
}

TEST(Experiment, FreshSamplesOfUniformCountsHaveTheErrorOfTheHalves) {
  const std::vector<Cell> cells =
      all_cells({"scene"}, {method("uniform")}, {method("mean"), method("zero")}, {8, 25}, 1);
  for (const auto kind : {ReferenceKind::kIndependent, ReferenceKind::kHoldout,
                          ReferenceKind::kLeaveSelectedOut, ReferenceKind::kCrossfit}) {
    SCOPED_TRACE(reference_name(kind));
    Laboratory laboratory;
    ExperimentOptions options;
    options.fresh = true;
    options.reference = kind;
    const bool short_halves = kind == ReferenceKind::kCrossfit;
    const auto results = run_experiment(cells, options, laboratory.sources());
    ASSERT_EQ(results.size(), 4u);
    const FreshErrors& mean = *results[0].fresh;
    EXPECT_NEAR(mean.mse, mean.parts.bias2 + mean.parts.variance, 1e-12);
    EXPECT_NEAR(mean.mse / results[0].metrics["mse"].value, 1.0, 0.2);
    // Standard error 0.1 to 0.15: the noise of this picture is in few pixels.
    EXPECT_NEAR(mean.parts.bias2 / mean.mse, 0.0, 0.5);
    EXPECT_EQ(results[1].fresh->parts.variance, 0.0);  // a black image is all bias
    EXPECT_NEAR(results[1].fresh->mse, results[1].fresh->parts.bias2, 1e-12);
    EXPECT_NE(value_of(results[0], "relmse_variance"), "");
    // Of 48 samples a half has 24, or 12 with crossfit: too short for 25, and no error.
    EXPECT_FALSE(results[2].error.has_value() && !short_halves);
    EXPECT_FALSE(results[2].fresh.has_value());
    EXPECT_EQ(value_of(results[2], "mse_fresh"), "");
  }
}

TEST(Experiment, FreshSamplesChangeNoOtherColumn) {
  const std::vector<Cell> cells =
      all_cells({"scene"}, {method("uniform")}, {method("mean")}, {8}, 2);
  Laboratory laboratory;
  ExperimentOptions options;
  const auto without = run_experiment(cells, options, laboratory.sources());
  options.fresh = true;
  const auto with = run_experiment(cells, options, laboratory.sources());
  for (const ResultColumn& column : result_columns()) {
    const bool added = column.name.ends_with("_fresh") || column.name.ends_with("_bias2") ||
                       column.name.ends_with("_variance") || column.name == "halves_saturated";
    if (column.kind == ColumnKind::kTiming) continue;
    EXPECT_EQ(added, column.text(without[1]) != column.text(with[1])) << column.name;
  }
}

TEST(Experiment, RunsBesideEachOtherChangeNoResult) {
  std::vector<Cell> cells = all_cells(
      {"scene", "other", "absent"}, {method("uniform"), method("broken"), method("by_filter")},
      {method("mean"), method("zero"), method("unknown")}, {4, 8}, 3);
  Laboratory laboratory;
  const auto alone = run_experiment(cells, {}, laboratory.sources());
  const std::map<std::string, int> sampled = laboratory.sampled;
  for (const int at_once : {1, 2, 3}) {
    Laboratory beside;
    ExperimentSources sources = beside.sources();
    sources.runs_at_once = [&](const RecordedSamples&) { return at_once; };
    std::atomic<int> inside = 0;
    int finished = 0;
    double share = 0.0;
    const ExperimentCallbacks callbacks{.finished =
                                            [&](CellResult&, const CellImages*) {
                                              EXPECT_EQ(inside++, 0) << "two callbacks at a time";
                                              ++finished;
                                              --inside;
                                            },
                                        .progress =
                                            [&](double now) {
                                              EXPECT_EQ(inside++, 0) << "two callbacks at a time";
                                              EXPECT_GE(now, share);
                                              share = now;
                                              --inside;
                                            },
                                        .cancelled = {}};
    const auto results = run_experiment(cells, {}, sources, callbacks);
    EXPECT_EQ(finished, static_cast<int>(cells.size()));
    EXPECT_DOUBLE_EQ(share, 1.0);
    EXPECT_EQ(beside.loads, laboratory.loads);
    EXPECT_EQ(beside.sampled, sampled);
    ASSERT_EQ(results.size(), alone.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
      for (const ResultColumn& column : result_columns()) {
        if (column.kind == ColumnKind::kTiming) continue;
        ASSERT_EQ(column.text(results[i]), column.text(alone[i])) << column.name << " " << i;
      }
      const bool loaded = cells[i].dump != "absent";
      EXPECT_EQ(value_of(results[i], "timing"), at_once > 1 && loaded ? "shared" : "alone") << i;
      if (results[i].error) continue;
      EXPECT_EQ(value_of(results[i], "peak_memory_mb").empty(), at_once > 1);
    }
  }
}

TEST(Experiment, CellsThatMeasureTimeRunAlone) {
  Laboratory laboratory;
  ExperimentSources sources = laboratory.sources();
  sources.runs_at_once = [](const RecordedSamples&) { return 3; };
  ExperimentOptions options;
  options.repeats = 2;
  const auto cells = all_cells({"scene"}, {method("uniform")}, {method("mean")}, {4}, 2);
  for (const CellResult& result : run_experiment(cells, options, sources))
    EXPECT_EQ(value_of(result, "timing"), "alone");
  const auto threads = all_cells({"scene"}, {method("uniform")}, {method("mean")}, {4}, 2, {1, 2});
  for (const CellResult& result : run_experiment(threads, {}, sources))
    EXPECT_EQ(value_of(result, "timing"), "alone");
}

TEST(Experiment, CancellingEndsRunsBesideEachOther) {
  Laboratory laboratory;
  ExperimentSources sources = laboratory.sources();
  sources.runs_at_once = [](const RecordedSamples&) { return 3; };
  int finished = 0;
  const ExperimentCallbacks callbacks{
      .finished = [&](CellResult&, const CellImages*) { ++finished; },
      .progress = {},
      .cancelled = [&] { return finished >= 2; }};
  const auto cells = all_cells({"scene"}, {method("uniform")}, {method("mean")}, {4}, 40);
  const auto results = run_experiment(cells, {}, sources, callbacks);
  EXPECT_EQ(static_cast<int>(results.size()), finished);
  EXPECT_GE(finished, 2);
  EXPECT_LE(finished, 2 + 3);  // those at work end
}

TEST(Experiment, AFailedCellIsKeptAndTheOthersGoOn) {
  Laboratory laboratory;
  const auto results = run_experiment({{"one", method("broken"), method("mean"), 4, 0},
                                       {"absent", method("uniform"), method("mean"), 4, 0},
                                       {"one", method("uniform"), method("unknown"), 4, 0},
                                       {"one", method("uniform"), method("mean"), 4, 0}},
                                      {}, laboratory.sources());
  ASSERT_EQ(results.size(), 4u);
  EXPECT_EQ(results[0].error->message, "broken on purpose");
  EXPECT_EQ(results[1].error->code, ErrorCode::kIo);
  EXPECT_EQ(results[2].error->code, ErrorCode::kUsage);
  EXPECT_FALSE(results[3].error.has_value());
  EXPECT_EQ(value_of(results[0], "mse"), "");
  EXPECT_EQ(value_of(results[0], "error"), "broken on purpose");
}

TEST(Experiment, CellsRunOnTheThreadsThatTheyAskFor) {
  Laboratory laboratory;
  const auto cells =
      all_cells({"one"}, {method("uniform")}, {method("mean"), method("zero")}, {4}, 2, {1, 2});
  const auto results = run_experiment(cells, {}, laboratory.sources());
  ASSERT_EQ(results.size(), 8u);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].threads, cells[i].threads);
    EXPECT_EQ(value_of(results[i], "threads"), std::to_string(cells[i].threads));
  }
  EXPECT_EQ(results[0].metrics["mse"].value, results[2].metrics["mse"].value);
}

TEST(Experiment, RepeatsChangeTimesOnly) {
  Laboratory once, thrice;
  const auto cells = all_cells({"one"}, {method("uniform")}, {method("mean")}, {4}, 1);
  ExperimentOptions options;
  const auto a = run_experiment(cells, options, once.sources());
  options.repeats = 3;
  const auto b = run_experiment(cells, options, thrice.sources());
  EXPECT_EQ(once.sampled["uniform"], 1);
  EXPECT_EQ(thrice.sampled["uniform"], 3);
  EXPECT_EQ(a[0].metrics["mse"].value, b[0].metrics["mse"].value);
  EXPECT_EQ(a[0].sampling.spread, 0.0);
  EXPECT_GT(b[0].sampling.spread, 0.0);
  EXPECT_GT(a[0].peak_memory.value_or(0), 1u << 20);
}

TEST(Experiment, MasksGiveTheEnergyOfTheirRecording) {
  Laboratory laboratory;
  ExperimentOptions options;
  EnergyMask left{"left", "one", "left.exr", Plane(40, 30)};
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 20; ++x)
      left.plane(x, y) = 1.0;
  }
  EnergyMask small{"small", "other", "small.exr", Plane(8, 8)};
  options.masks = {left, small};
  const auto results =
      run_experiment(all_cells({"one", "other"}, {method("uniform")}, {method("mean")}, {8}, 1),
                     options, laboratory.sources());
  ASSERT_EQ(results[0].masks.size(), 1u);
  EXPECT_NEAR(results[0].masks[0].second.value, 1.0, 0.05);
  EXPECT_EQ(value_of(results[0], "energy_masks"),
            "left=" + format_number(results[0].masks[0].second.value));
  ASSERT_TRUE(results[1].error.has_value());
  EXPECT_NE(results[1].error->message.find("small.exr: is 8 x 8 pixels"), std::string::npos);
}

TEST(EnergyMasks, AreTheRatioOfSumsInsideThem) {
  RgbImage estimate = make_rgb(20, 20), reference = make_rgb(20, 20);
  EnergyMask mask{"m", "", "m.exr", Plane(20, 20)};
  for (std::size_t c = 0; c < 3; ++c) {
    for (int i = 0; i < 20; ++i) {
      estimate[c](i, 3) = 1.0 + i;
      reference[c](i, 3) = 2.0;
      estimate[c](i, 4) = 1e6;
    }
  }
  for (int i = 0; i < 20; ++i)
    mask.plane(i, 3) = 1.0;
  estimate[1](7, 3) = std::nan("");  // that pixel is left out of both sums
  const auto ratio = energy_in_mask(estimate, reference, mask);
  ASSERT_TRUE(ratio.has_value());
  EXPECT_NEAR(ratio->value, (3 * 210.0 - 3 * 8.0) / (3 * 19 * 2.0), 1e-12);
  EXPECT_TRUE(std::isnan(energy_in_mask(estimate, make_rgb(20, 20), mask)->value));
}

TEST(Experiment, AnExceptionIsTheErrorOfItsCell) {
  Laboratory laboratory;
  ExperimentSources sources = laboratory.sources();
  sources.filter = [](const MethodChoice& choice) -> Result<ReadyFilter> {
    if (choice.name == "mean") return Laboratory::filter(choice);
    return ReadyFilter{
        [](const Selection&, const SamplePool&, const FilterContext&) -> Result<Reconstruction> {
          throw std::bad_alloc();
        },
        {}};
  };
  const auto results = run_experiment(
      all_cells({"one"}, {method("uniform")}, {method("huge"), method("mean")}, {4}, 1), {},
      sources);
  ASSERT_TRUE(results[0].error.has_value());
  EXPECT_EQ(results[0].error->code, ErrorCode::kIo);
  EXPECT_NE(results[0].error->message.find("out of memory"), std::string::npos);
  EXPECT_FALSE(results[1].error.has_value());
}

TEST(Experiment, AnImageThatIsNotFiniteIsMarkedAsFailed) {
  Laboratory laboratory;
  const auto results =
      run_experiment({{"one", method("uniform"), method("nan"), 4, 0}}, {}, laboratory.sources());
  EXPECT_FALSE(results[0].error.has_value());
  EXPECT_TRUE(results[0].metrics.failed);
  EXPECT_EQ(value_of(results[0], "excluded_image"), "1");
  EXPECT_EQ(value_of(results[0], "error"), "image not finite");
}

// Replicates side by side take every sample of a recording once: their means have the mean of all.
TEST(Experiment, ReplicatesShareNoSampleWhereTheyFit) {
  Laboratory laboratory;
  ExperimentOptions options;
  std::vector<RgbImage> images;
  const auto mean_of_images = [&](ReplicateOrder order) {
    options.order = order;
    images.clear();
    ExperimentCallbacks callbacks;
    callbacks.finished = [&](CellResult&, const CellImages* shown) {
      ASSERT_NE(shown, nullptr);
      images.push_back(shown->image);
    };
    run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {12}, 4), options,
                   laboratory.sources(), callbacks);
    double sum = 0.0;
    for (const RgbImage& image : images)
      sum += image[0](3, 2) / 4.0;
    return sum;
  };
  double all = 0.0;
  const RecordedSamples recording = make_scene_s(40, 30, 48, 1);
  for (int s = 0; s < recording.spp(); ++s)
    all += static_cast<double>(recording.radiance(3, 2, s)[0]) / recording.spp();
  EXPECT_NEAR(mean_of_images(ReplicateOrder::kDisjoint), all, 1e-12);
  const RgbImage first = images.front();
  EXPECT_GT(std::abs(mean_of_images(ReplicateOrder::kShuffled) - all), 1e-6);
  EXPECT_EQ(images.front(), first);  // the first replicate is the same in both
}

TEST(Experiment, RecordedOrderHasOneReplicate) {
  Laboratory laboratory;
  ExperimentOptions options;
  options.order = ReplicateOrder::kRecorded;
  const auto results =
      run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {4}, 2), options,
                     laboratory.sources());
  EXPECT_FALSE(results[0].error.has_value());
  EXPECT_TRUE(results[1].error.has_value());
}

TEST(Experiment, HandsOverImagesReportsProgressAndStopsWhenCancelled) {
  Laboratory laboratory;
  int finished = 0;
  double last = 0.0;
  ExperimentCallbacks callbacks;
  callbacks.finished = [&](const CellResult& result, const CellImages* images) {
    ++finished;
    ASSERT_NE(images, nullptr);
    EXPECT_EQ(images->image[0].width(), 40);
    EXPECT_EQ(images->selection.statistics.n(3, 3), 4);
    EXPECT_EQ(error_metrics(images->image, images->reference)["mse"].value,
              result.metrics["mse"].value);
  };
  callbacks.progress = [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  };
  callbacks.cancelled = [&] { return finished == 2; };
  const auto results =
      run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {4}, 4), {},
                     laboratory.sources(), callbacks);
  EXPECT_EQ(results.size(), 2u);
  EXPECT_EQ(last, 0.5);
}

TEST(Experiment, ResultsDoNotDependOnTheNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Laboratory laboratory;
    std::vector<double> values;
    for (const CellResult& result :
         run_experiment(all_cells({"one"}, {method("uniform")}, {method("mean")}, {4}, 2), {},
                        laboratory.sources())) {
      EXPECT_EQ(result.threads, threads);
      for (const MetricValue& metric : result.metrics.values)
        if (!std::isnan(metric.value)) values.push_back(metric.value);
    }
    return values;
  };
  const std::vector<double> once = run(1);
  EXPECT_EQ(run(2), once);
}

TEST(ResultTable, RowsHaveAFieldForEveryColumnAndQuoteWhatNeedsIt) {
  EXPECT_EQ(csv_header().substr(0, 33), "dump,sampler,filter,spp,replicate");
  CellResult result;
  result.cell = {"a \"b\", c", {"s", "p", {{"x", "1"}, {"y", "2"}}}, method("f"), 2.5, 3};
  result.error = Error{ErrorCode::kData, "no"};
  const std::string row = to_csv_row(result);
  EXPECT_EQ(row.substr(0, 58),
            "\"a \"\"b\"\", c\",\"s:p{x=1,y=2}\",f,2.5,3,0,\"a \"\"b\"\", c\",,,,,,,,");
  std::size_t commas = 0;
  bool quoted = false;
  for (const char c : row) {
    if (c == '"') quoted = !quoted;
    commas += c == ',' && !quoted;
  }
  EXPECT_EQ(commas + 1, result_columns().size());
}

TEST(ResultTable, RegionAreaIsThatOfTheSamplesOfRegions) {
  const auto area = [](std::vector<long long> samples_of_level) {
    CellResult result;
    result.metrics.values.resize(metrics().size());
    result.log.samples_of_level = std::move(samples_of_level);
    return result_fields(result)[column_index("region_area")];
  };
  EXPECT_EQ(area({900, 30, 0, 10}), "19");  // (30 x 4 + 10 x 64) / 40
  EXPECT_EQ(area({0, 0, 7, 0}), "16");
  EXPECT_EQ(area({900, 0, 0, 0}), "");
  EXPECT_EQ(area({}), "");
}

TEST(ResultTable, JsonLinesHaveNumbersNullsAndEscapedText) {
  CellResult result;
  result.cell = {"a \"b\"\n", method("s"), method("f"), 2.5, 3};
  result.metrics.values.resize(metrics().size());
  result.metrics.values[0] = {0.1, std::nan("")};
  result.metrics.values[static_cast<std::size_t>(metric_index("psnr_tm"))].value =
      std::numeric_limits<double>::infinity();
  const std::string line = to_json_line(result_fields(result));
  EXPECT_NE(line.find(R"("dump_path":"a \"b\"\n",)"), std::string::npos);
  EXPECT_EQ(line.substr(0, 52), R"({"dump":"a \"b\"\n","sampler":"s","filter":"f","spp")");
  EXPECT_NE(line.find(R"("mse":0.1,"mse_se":null,)"), std::string::npos);
  EXPECT_NE(line.find(R"("psnr_tm":"inf")"), std::string::npos);
  EXPECT_EQ(line.back(), '}');
}

TEST(ResultRecord, KeepsWhatPixelsTook) {
  Laboratory laboratory;
  const auto results =
      run_experiment({{"one", method("uniform"), method("mean"), 4, 0}}, {}, laboratory.sources());
  const ResultRecord record = record_of(results[0]);
  long long pieces = 0, samples = 0;
  for (const auto& [count, number] : record.counts) {
    pieces += number;
    samples += count * number;
  }
  EXPECT_EQ(pieces, results[0].width * results[0].height);
  EXPECT_EQ(samples, results[0].log.spent);
  EXPECT_EQ(record.number("recorded_spp"), results[0].recorded_spp);
}

TEST(ResultTable, ColumnsHaveUniqueNamesAndMeanings) {
  std::map<std::string, int> names;
  for (const ResultColumn& column : result_columns()) {
    EXPECT_EQ(++names[column.name], 1) << column.name;
    EXPECT_FALSE(column.meaning.empty());
  }
  for (const char* name :
       {"mse", "mse_se", "relmse", "relmse_trimmed", "energy_ratio", "energy_ratio_se",
        "seconds_sampling", "seconds_filtering", "samples_spent", "saturated", "guards"}) {
    EXPECT_EQ(names[name], 1) << name;
  }
}

TEST(ResultTable, EfficiencyIsUnresolvedWithinTwoStandardErrorsOfZero) {
  CellResult result;
  result.metrics.values.resize(metrics().size());
  result.sampling.wall = 1.0;
  result.filtering.wall = 3.0;
  MetricValue& mse = result.metrics.values[static_cast<std::size_t>(metric_index("mse"))];
  mse = {0.5, 0.1};
  EXPECT_DOUBLE_EQ(*efficiency(result), 1.0 / (0.5 * 4.0));
  result.cost_per_sample = 0.01;
  result.log.spent = 400;
  EXPECT_DOUBLE_EQ(*efficiency(result), 1.0 / (0.5 * 8.0));
  mse = {0.5, 0.3};
  EXPECT_FALSE(efficiency(result).has_value());
  mse = {0.5, std::nan("")};
  EXPECT_FALSE(efficiency(result).has_value());
}

}  // namespace
}  // namespace spool
