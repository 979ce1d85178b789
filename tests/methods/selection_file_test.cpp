// What replay writes and reconstruct reads: the same image to the last bit.
#include "tools/methods/selection_file.h"

#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "lib/experiment/decision_split.h"
#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/every_method.h"
#include "tests/support/scratch_folder.h"

namespace spool::tools {
namespace {

TEST(SelectionFile, GivesTheSameImageToTheLastBit) {
  const test::ScratchFolder folder;
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  options.seed = 0x9E3779B97F4A7C15u;
  const auto noisy = test::noisy_pool(19, 14, 16);
  const auto recording = std::make_shared<const RecordedSamples>(noisy.recording());
  const SamplePool pool = test::pool_of(recording, options);
  SamplingContext context;
  context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
    GuardCounts guards;
    return pixel_means(selection.statistics, guards);
  };
  std::vector<std::pair<std::string, OptionValues>> methods;
  for (const Sampler& entry : samplers())
    methods.emplace_back(entry.name, OptionValues{});
  methods.push_back({"multiscale", {{"analysis_channel", "max_rgb"}}});
  methods.push_back({"multiscale", {{"update", "exact"}}});
  for (const auto& [name, set] : methods) {
    const auto sampled = (*make_method(samplers(), {name, "", set}))(pool, 19 * 14 * 6, context);
    ASSERT_TRUE(sampled.has_value()) << name << ": " << sampled.error().message;
    const auto path = folder / "selection.exr";
    ASSERT_TRUE(write_selection(path, sampled->selection, {name, "noisy", options}, true));
    const auto file = read_selection(path);
    ASSERT_TRUE(file.has_value()) << file.error().message;
    const SamplePool again = test::pool_of(recording, *file->pool);
    const auto selection = apply_selection(*file, path, again);
    ASSERT_TRUE(selection.has_value()) << selection.error().message;
    EXPECT_EQ(selection->statistics, sampled->selection.statistics) << name;
    EXPECT_EQ(selection->attenuation, sampled->selection.attenuation) << name;
    const auto filter =
        average_halves(*make_method(filters(), {"directional", "", {{"size_factor", "literal"}}}));
    EXPECT_EQ(filter(*selection, again, FilterContext{})->image,
              filter(sampled->selection, pool, FilterContext{})->image);
  }
}

TEST(SelectionFile, WritesTheBitsOfAnAttenuationWhereItIsMoreThanAFloat) {
  const test::ScratchFolder folder;
  const SamplePool pool = test::noisy_pool(19, 14, 16);
  for (const bool exact : {false, true}) {
    const OptionValues set = exact ? OptionValues{{"update", "exact"}} : OptionValues{};
    const auto sampled =
        (*make_method(samplers(), {"multiscale", "", set}))(pool, 19 * 14 * 6, SamplingContext{});
    const auto path = folder / "selection.exr";
    ASSERT_TRUE(write_selection(path, sampled->selection, {"multiscale", "noisy", {}}, true));
    const auto file = read_exr(path);
    EXPECT_NE(file->find("A.2"), nullptr);
    EXPECT_EQ(file->find("A_bits.2.high") != nullptr, exact);
    EXPECT_EQ(file->find("A_bits.2.low") != nullptr, exact);
  }
}

TEST(SelectionFile, HoldsASplitDecisionToTheLastBit) {
  const test::ScratchFolder folder;
  const SamplePool pool = test::noisy_pool(19, 14, 32);
  const auto sampler = split_decisions(*make_method(samplers(), {"multiscale", "", {}}));
  const auto sampled = sampler(pool, 19 * 14 * 8, SamplingContext{});
  const auto path = folder / "selection.exr";
  ASSERT_TRUE(write_selection(path, sampled->selection, {"multiscale", "noisy", {}}, false));
  const auto file = read_selection(path);
  ASSERT_TRUE(file.has_value()) << file.error().message;
  const auto selection = apply_selection(*file, path, pool);
  ASSERT_TRUE(selection.has_value()) << selection.error().message;
  ASSERT_EQ(selection->halves.size(), 2u);
  for (std::size_t h = 0; h < 2; ++h) {
    EXPECT_EQ(selection->halves[h].statistics, sampled->selection.halves[h].statistics);
    EXPECT_EQ(selection->halves[h].attenuation, sampled->selection.halves[h].attenuation);
  }
  const auto filter =
      average_halves(*make_method(filters(), {"directional", "", {{"size_factor", "literal"}}}));
  EXPECT_EQ(filter(*selection, pool, FilterContext{})->image,
            filter(sampled->selection, pool, FilterContext{})->image);

  auto cut = read_exr(path);
  std::erase_if(cut->channels, [](const NamedPlane& plane) { return plane.name == "odd.n"; });
  cut->number_attributes.clear();
  ASSERT_TRUE(write_exr(path, *cut, {.overwrite = true}));
  EXPECT_EQ(read_selection(path).error().code, ErrorCode::kData);
}

TEST(SelectionFile, ASumThatIsNotThatOfTheHalvesIsRefused) {
  const test::ScratchFolder folder;
  const SamplePool pool = test::noisy_pool(8, 8, 16);
  const auto sampled = (*make_method(samplers(), {"cross_halves", "", {}}))(
      pool, 8 * 8 * 6, test::sampling_context());
  const auto path = folder / "selection.exr";
  ASSERT_TRUE(write_selection(path, sampled->selection, {"cross_halves", "noisy", {}}, false));
  auto file = read_exr(path);
  for (NamedPlane& channel : file->channels) {
    if (channel.name == "n") channel.data(3, 4) += 1.0;
  }
  file->number_attributes.clear();
  ASSERT_TRUE(write_exr(path, *file, {.overwrite = true}));
  const auto applied = apply_selection(*read_selection(path), path, pool);
  ASSERT_FALSE(applied.has_value());
  EXPECT_EQ(applied.error().code, ErrorCode::kData);
  EXPECT_NE(applied.error().message.find("even.n"), std::string::npos);
}

TEST(SelectionFile, AnAttenuationThatSomebodyChangedIsTaken) {
  const test::ScratchFolder folder;
  const SamplePool pool = test::noisy_pool(8, 8, 16);
  const auto sampled = (*make_method(samplers(), {"multiscale", "", {{"update", "exact"}}}))(
      pool, 8 * 8 * 6, SamplingContext{});
  const auto path = folder / "selection.exr";
  ASSERT_TRUE(write_selection(path, sampled->selection, {"multiscale", "noisy", {}}, false));
  auto file = read_exr(path);
  for (NamedPlane& channel : file->channels) {
    if (channel.name == "A.2") channel.data(3, 4) = 0.25;
  }
  file->number_attributes.clear();
  const auto written = write_exr(path, *file, {.overwrite = true});
  ASSERT_TRUE(written.has_value()) << written.error().message;
  const auto changed = read_selection(path);
  Plane expected = sampled->selection.attenuation[2];
  expected(3, 4) = 0.25;
  EXPECT_EQ(changed->attenuation[2], expected);
}

TEST(SelectionFile, AnOrderOfSamplesThatSomebodyChangedIsRefused) {
  const test::ScratchFolder folder;
  const SamplePool pool = test::noisy_pool(8, 8, 16);
  const auto sampled =
      (*make_method(samplers(), {"uniform", "", {}}))(pool, 8 * 8 * 6, SamplingContext{});
  const auto path = folder / "selection.exr";
  ASSERT_TRUE(write_selection(path, sampled->selection, {"uniform", "noisy", {}}, false));
  ExrFile sound = *read_exr(path);
  sound.number_attributes = {{"spool.holdout", 0.0}, {"spool.pieces_per_side", 1.0}};
  const auto expect_refused = [&](const std::string& name, const ExrFile& changed) {
    const auto written = write_exr(path, changed, {.overwrite = true});
    ASSERT_TRUE(written.has_value()) << written.error().message;
    const auto read = read_selection(path);
    ASSERT_FALSE(read.has_value()) << name;
    EXPECT_EQ(read.error().code, ErrorCode::kData);
    EXPECT_NE(read.error().message.find(name), std::string::npos) << read.error().message;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [name, value] : {std::pair{"spool.holdout", kNaN},
                                    {"spool.holdout", 1.5},
                                    {"spool.holdout", -1.0},
                                    {"spool.holdout", 1e300},
                                    {"spool.pieces_per_side", kNaN},
                                    {"spool.pieces_per_side", 3.0}}) {
    ExrFile changed = sound;
    changed.number_attributes[name] = value;
    expect_refused(name, changed);
  }
  for (const auto& [name, value] : {std::pair{"spool.pool_order", "shufled"},
                                    {"spool.pool_seed", "x"},
                                    {"spool.pool_seed", "-1"},
                                    {"spool.pool_seed", ""}}) {
    ExrFile changed = sound;
    changed.text_attributes[name] = value;
    expect_refused(name, changed);
  }
}

}  // namespace
}  // namespace spool::tools
