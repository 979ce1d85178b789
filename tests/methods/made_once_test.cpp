// A command makes each of its methods once, whatever it asks of it before the work: memory, layers.
#include <gtest/gtest.h>

#include "lib/filters/box.h"
#include "lib/sampling/uniform.h"
#include "tests/support/memory_pool.h"
#include "tools/methods/called_methods.h"
#include "tools/verbs/reconstruct.h"
#include "tools/verbs/replay.h"

namespace spool::tools {
namespace {

class MadeOnce : public ::testing::Test {
 protected:
  void SetUp() override {
    provide_called_methods({[this](const std::string&, const OptionValues&) {
                              ++samplers_;
                              return uniform_sampler().make("", {});
                            },
                            [this](const std::string&, const OptionValues&) {
                              ++filters_;
                              return box_filter().make("", {});
                            }});
  }
  void TearDown() override { provide_called_methods({}); }

  static LoadRecording noise() {
    return [](const SanitiseRules&, const WorkingMemory&, SampleFilm, FirstPass*) {
      return Result<std::shared_ptr<const RecordedSamples>>(
          test::memory_recording(6, 5, 8, [](int x, int, int s) {
            const auto v = static_cast<float>(x + s);
            return Rgb{v, v, v};
          }));
    };
  }

  int samplers_ = 0, filters_ = 0;
};

TEST_F(MadeOnce, TheFilterOfAReconstruction) {
  ReconstructOptions options;
  options.filter = "python:mine";
  options.spp = 4;
  const auto done = reconstruct(options, std::nullopt, noise(), {});
  ASSERT_TRUE(done.has_value()) << done.error().message;
  EXPECT_EQ(filters_, 1);
  EXPECT_EQ(done->made.image[0](2, 1), 2 + 1.5);
}

TEST_F(MadeOnce, TheSamplerOfAReplayAndTheFilterInItsLoop) {
  ReplayOptions options;
  options.sampler = "python:mine";
  options.spp = 4;
  ASSERT_TRUE(replay(options, noise(), {}).has_value());
  EXPECT_EQ(samplers_, 1);
  options.sampler = "filtered_halves";
  options.filter = "python:mine";
  const auto done = replay(options, noise(), {});
  ASSERT_TRUE(done.has_value()) << done.error().message;
  EXPECT_EQ(filters_, 1);
}

// A setting may be for the filter that the sampler names for its loop.
TEST(LoopFilter, TakesSettingsThatNobodyNamedItFor) {
  const auto chosen = choose_with_loop_filter("cross_halves{filter=gaussian}", "",
                                              {.preset = "", .settings = {"filter.sigma=2"}});
  ASSERT_TRUE(chosen.has_value()) << chosen.error().message;
  ASSERT_EQ(chosen->filters.size(), 1u);
  EXPECT_EQ(chosen->filters[0].choice.text(), "gaussian{sigma=2}");
  EXPECT_TRUE(choose_with_loop_filter("uniform", "", {})->filters.empty());
}

}  // namespace
}  // namespace spool::tools
