// Every sampler with every filter, on a synthetic dump and on recorded ones.
#include <cmath>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/filters/filters.h"
#include "lib/pool/load_recording.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "lib/synthetic/write_synthetic.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/source_directory.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

// Small windows: the law is about the pair, not about quality.
OptionValues fast(const std::string& name) {
  if (name == "nl_means") return {{"window", "2"}, {"patch", "1"}};
  return {};
}

// What a method needs and this recording does not have.
bool lacks_features(const RecordedSamples& recording, const Needs& needs) {
  return needs.features == Use::kRequired && recording.features().empty();
}

void expect_refused(const Error& error, const std::string& who) {
  EXPECT_TRUE(error.code == ErrorCode::kData || error.code == ErrorCode::kUsage) << who;
  EXPECT_NE(error.message.find("need"), std::string::npos) << who << ": " << error.message;
}

void run_every_pair(const SamplePool& pool, double spp, const std::set<std::string>& only = {}) {
  const RecordedSamples& recording = pool.recording();
  const long long budget = sample_budget(spp, recording);
  for (const Sampler& sampler : samplers()) {
    if (!only.empty() && !only.contains(sampler.name)) continue;
    const auto sample = *make_method(samplers(), {sampler.name, "", fast(sampler.name)});
    std::optional<Selection> shared;  // of samplers that do not care for the filter
    for (const Filter& named : filters()) {
      const std::string pair = sampler.name + " + " + named.name;
      const auto filter = *make_method(filters(), {named.name, "", fast(named.name)});
      if (!shared || sample.needs.filter_in_loop) {
        SamplingContext context;
        context.seed = 3;
        if (sample.needs.filter_in_loop) context.filter = loop_filter(filter);
        auto sampled = sample(pool, budget, context);
        // A filter in the loop must not see the reference.
        const bool refused = lacks_features(recording, sample.needs) ||
                             (sample.needs.filter_in_loop &&
                              (filter.needs.reference || lacks_features(recording, filter.needs)));
        ASSERT_EQ(!sampled.has_value(), refused)
            << pair << (sampled ? "" : ": " + sampled.error().message);
        if (refused) {
          expect_refused(sampled.error(), pair);
          continue;
        }
        EXPECT_EQ(sampled->log.spent, budget) << pair;
        shared = sampled->selection;
      }
      FilterContext context;
      context.reference = &*recording.reference();
      const auto result = average_halves(filter)(*shared, pool, context);
      if (lacks_features(recording, filter.needs)) {
        ASSERT_FALSE(result.has_value()) << pair;
        expect_refused(result.error(), pair);
        continue;
      }
      ASSERT_TRUE(result.has_value()) << pair << ": " << result.error().message;
      double sum = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(result->image[c].width(), recording.width()) << pair;
        ASSERT_EQ(result->image[c].height(), recording.height()) << pair;
        for (const double v : result->image[c].pixels()) {
          ASSERT_TRUE(std::isfinite(v)) << pair;
          sum += v;
        }
      }
      double expected = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        for (const double v : recording.reference()->mean[c].pixels())
          expected += v;
      }
      // An image of the scene, not of something else. Welch's test refuses no neighbour to a pixel
      // of two samples: behind counts as uneven as the oracle's, lamps of many samples spread.
      if (pair == "neyman + welch" || pair == "neyman + stater") continue;
      EXPECT_NEAR(sum / expected, 1.0, 0.35) << pair;
    }
  }
}

std::shared_ptr<const RecordedSamples> load(const std::filesystem::path& path) {
  auto recording = load_recording(path);
  if (!recording) {
    ADD_FAILURE() << recording.error().message;
    return nullptr;
  }
  return *recording;
}

SamplePool pool_of(std::shared_ptr<const RecordedSamples> recording, int pieces_per_side) {
  PoolOptions options;
  options.pieces_per_side = pieces_per_side;
  options.order = PoolOrder::kShuffled;
  options.seed = 5;
  return *SamplePool::create(std::move(recording), options);
}

TEST(EveryPair, RunsOnASyntheticDump) {
  const test::ScratchFolder folder;
  const auto path = folder / "s.spool";
  ASSERT_TRUE(write_synthetic("scene_s", 33, 25, 32, 1, path).has_value());
  const auto recording = load(path);
  ASSERT_NE(recording, nullptr);
  // More than filtered_halves and cross_halves spend before they filter.
  for (const auto& [pieces_per_side, spp] : {std::pair{1, 8}, {2, 24}})
    run_every_pair(pool_of(recording, pieces_per_side), spp);
}

TEST(EveryPair, RunsOnARecordedDump) {
  const auto recording = load(test::source_directory() / "dumps/tiny/chess.spool");
  ASSERT_NE(recording, nullptr);
  run_every_pair(pool_of(recording, 1), 8);
}

TEST(EveryPair, RunsOnQuarterPixels) {
  const auto recording = load(test::source_directory() / "dumps/tiny/chess.spool");
  ASSERT_NE(recording, nullptr);
  run_every_pair(pool_of(recording, 2), 16, {"uniform", "multiscale"});
}

}  // namespace
}  // namespace spool::tools
