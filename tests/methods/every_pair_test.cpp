// Every sampler with every reconstructor, on a synthetic dump and on recorded ones.
#include <cmath>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "lib/pool/load_recording.h"
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

// Synthetic scenes have no features; what needs them must say so.
bool refused_without_features(const RecordedSamples& recording, const std::string& method,
                              const Error& error) {
  return method == "cross_bilateral" && recording.features().empty() &&
         error.message.find("needs albedo, normal or depth") != std::string::npos;
}

void run_every_pair(const SamplePool& pool, double spp, const std::set<std::string>& only = {}) {
  const RecordedSamples& recording = pool.recording();
  const long long budget = sample_budget(spp, recording);
  for (const SamplerEntry& sampler : samplers()) {
    if (!only.empty() && !only.contains(sampler.name)) continue;
    std::optional<Selection> shared;  // of samplers that do not care for the filter
    for (const ReconstructorEntry& reconstructor : reconstructors()) {
      const std::string pair = sampler.name + " + " + reconstructor.name;
      const auto filter = reconstructor.make("", fast(reconstructor.name));
      ASSERT_TRUE(filter.has_value()) << pair;
      bool filter_in_loop = false;
      if (!shared) {
        SamplingContext context;
        context.seed = 3;
        context.filter = [&](const Selection& half, const SamplePool& part) -> Result<RgbImage> {
          filter_in_loop = true;
          SPOOL_ASSIGN(Reconstruction image, (*filter)(half, part, {}));
          return std::move(image.image);
        };
        auto sampled = (*sampler.make("", fast(sampler.name)))(pool, budget, context);
        if (!sampled) {  // refused, with the reason
          if (refused_without_features(recording, sampler.name, sampled.error())) break;
          if (sampler.name == "filtered_halves" &&
              refused_without_features(recording, reconstructor.name, sampled.error()))
            continue;
          EXPECT_EQ(pair, "filtered_halves + oracle_scale") << sampled.error().message;
          EXPECT_NE(sampled.error().message.find("reference"), std::string::npos);
          continue;
        }
        EXPECT_EQ(sampled->log.spent, budget) << pair;
        if (!filter_in_loop) shared = sampled->selection;
        if (filter_in_loop) {
          ReconstructionContext of_image;
          of_image.reference = &*recording.reference();
          ASSERT_TRUE((*filter)(sampled->selection, pool, of_image).has_value()) << pair;
          continue;
        }
      }
      ReconstructionContext context;
      context.reference = &*recording.reference();
      const auto result = (*filter)(*shared, pool, context);
      if (!result && refused_without_features(recording, reconstructor.name, result.error()))
        continue;
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
      EXPECT_NEAR(sum / expected, 1.0, 0.35)
          << pair;  // an image of the scene, not of something else
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
  for (const int pieces_per_side : {1, 2})
    run_every_pair(pool_of(recording, pieces_per_side), 8);
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
