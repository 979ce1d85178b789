// What `spool list views` names is what methods hand over, and nothing else.
#include "tools/methods/view_files.h"

#include <set>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/scratch_folder.h"

namespace spool::tools {
namespace {

std::set<std::string> families(const Views& views) {
  std::set<std::string> names;
  for (const View& view : views.collected())
    names.insert(view.name.substr(0, view.name.find('.')));
  return names;
}

std::set<std::string> families(const std::vector<ViewDescription>& views) {
  std::set<std::string> names;
  for (const ViewDescription& view : views)
    names.insert(view.name.substr(0, view.name.find('.')));
  return names;
}

OptionValues fast(const std::string& name) {
  if (name == "nl_means") return {{"window", "2"}, {"patch", "1"}};
  return {};
}

TEST(Views, OfSamplersAreThoseListedAndComeOnce) {
  const SamplePool pool = test::noisy_pool(21, 18, 16);
  for (const Sampler& entry : samplers()) {
    Views views({"all"});
    SamplingContext context;
    context.views = &views;
    context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
      GuardCounts guards;
      return pixel_means(selection.statistics, guards);
    };
    const auto result = (*entry.make("", fast(entry.name)))(pool, 21 * 18 * 8, context);
    ASSERT_TRUE(result.has_value()) << entry.name;
    EXPECT_EQ(families(views), families(entry.views)) << entry.name;
    std::set<std::string> names;
    for (const View& view : views.collected()) {
      EXPECT_TRUE(names.insert(view.name).second) << entry.name << " " << view.name;
      EXPECT_TRUE(view.image.same_size(result->selection.statistics.n)) << view.name;
    }
  }
}

TEST(Views, OfFiltersAreThoseListedAndComeOnce) {
  const SamplePool pool = test::noisy_pool(21, 18, 8);
  const Selection selection{prefix_statistics(pool, CountImage(21, 18, 6)), {}};
  const Reference reference{selection.statistics.mean, std::nullopt};
  for (const Filter& entry : filters()) {
    Views views({"all"});
    FilterContext context;
    context.views = &views;
    context.reference = &reference;
    const auto result = (*entry.make("", fast(entry.name)))(selection, pool, context);
    ASSERT_TRUE(result.has_value()) << entry.name;
    EXPECT_EQ(families(views), families(entry.views)) << entry.name;
    add_selection_views(selection, views);
    add_image_views(*result, views);
    std::set<std::string> names;
    for (const View& view : views.collected())
      EXPECT_TRUE(names.insert(view.name).second) << entry.name << " " << view.name;
  }
}

TEST(Views, ChangeNoBit) {
  const SamplePool pool = test::noisy_pool(21, 18, 16);
  const auto sampler = *make_method(samplers(), {"multiscale", "", {}});
  const auto filter = *make_method(filters(), {"directional", "", {}});
  Views views({"all"});
  SamplingContext watched;
  watched.views = &views;
  const auto plain = sampler(pool, 21 * 18 * 8, SamplingContext{});
  const auto seen = sampler(pool, 21 * 18 * 8, watched);
  EXPECT_EQ(plain->selection.statistics, seen->selection.statistics);
  Views image_views({"all"});
  FilterContext context;
  context.views = &image_views;
  EXPECT_EQ(filter(plain->selection, pool, FilterContext{})->image,
            filter(plain->selection, pool, context)->image);
}

TEST(Views, AreWrittenAsLayersAndPictures) {
  const test::ScratchFolder folder;
  Views views({"all"});
  Plane ramp(5, 4);
  for (std::size_t i = 0; i < ramp.size(); ++i)
    ramp[i] = static_cast<double>(i);
  views.add("P.1", ramp);
  views.add("level", ramp);
  views.add("dominant_direction", ramp);
  views.add("delta.0", Plane(10, 8));
  ExrFile file;
  file.width = 5;
  file.height = 4;
  EXPECT_EQ(add_view_layers(views, file), std::vector<std::string>{"delta.0"});
  EXPECT_EQ(file.channels.size(), 3u);
  EXPECT_EQ(*file.find("view.P.1"), ramp);
  const auto written = write_view_pictures(views, folder / "views", false);
  ASSERT_TRUE(written.has_value()) << written.error().message;
  for (const char* name : {"P.1.png", "level.png", "dominant_direction.png", "delta.0.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / "views" / name)) << name;
  EXPECT_EQ(write_view_pictures(views, folder / "views", false).error().code, ErrorCode::kUsage);
}

TEST(Views, UnknownNamesAreRefusedWithTheNearest) {
  const std::vector<ViewDescription> known = {{"stop.k", ""}, {"level", ""}};
  EXPECT_TRUE(check_views({"stop", "stop.3", "level", "all"}, known).has_value());
  const auto wrong = check_views({"levle"}, known);
  ASSERT_FALSE(wrong.has_value());
  EXPECT_NE(wrong.error().message.find("did you mean 'level'"), std::string::npos);
}

}  // namespace
}  // namespace spool::tools
