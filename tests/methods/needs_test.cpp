// What methods say they need is what they use: without what they do not name nothing changes.
#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/sampling/spending.h"
#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kWidth = 19, kHeight = 14, kSpp = 12;

double noise(int x, int y, int s, int lane) {
  return unit_double(mix(std::uint64_t{5}, x, y, s, lane));
}

enum class Film { kNone, kRecorded };
enum class Features { kNone, kRecorded };

SamplePool pool_with(Film film, Features features) {
  std::vector<float> radiance;
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int s = 0; s < kSpp; ++s)
          radiance.push_back(static_cast<float>((x > y ? 2.0 : 0.5) * (0.2 + noise(x, y, s, c))));
      }
    }
  }
  auto recording =
      RecordedSamples::from_memory("needs", kWidth, kHeight, kSpp, std::move(radiance));
  SPOOL_CHECK(recording.has_value());
  if (film == Film::kRecorded) {
    std::vector<FilmPosition> positions;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int s = 0; s < kSpp; ++s)
          positions.push_back(
              {static_cast<float>(noise(x, y, s, 3)), static_cast<float>(noise(x, y, s, 4))});
      }
    }
    recording->set_sample_film(std::move(positions));
  }
  if (features == Features::kRecorded) test::add_features(*recording);
  return test::pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)));
}

bool same(const SamplingResult& a, const SamplingResult& b) {
  return a.selection.statistics == b.selection.statistics &&
         a.selection.attenuation == b.selection.attenuation;
}
bool same(const Reconstruction& a, const Reconstruction& b) {
  return a.image == b.image;
}

// The outcome with everything recorded, and without one thing that a method may or may not use.
template <class Outcome>
void expect_use(Use use, const Outcome& with, const Outcome& without, const std::string& who) {
  ASSERT_TRUE(with.has_value()) << who << ": " << with.error().message;
  ASSERT_EQ(without.has_value(), use != Use::kRequired) << who;
  if (!without) {
    EXPECT_EQ(without.error().code, ErrorCode::kData) << who;
  } else {
    EXPECT_EQ(same(*with, *without), use == Use::kNone) << who;
  }
}

TEST(Needs, OfSamplersAreWhatTheyUse) {
  const SamplePool whole = pool_with(Film::kRecorded, Features::kRecorded);
  const SamplePool no_film = pool_with(Film::kNone, Features::kRecorded);
  const SamplePool no_features = pool_with(Film::kRecorded, Features::kNone);
  const long long budget = 5LL * kWidth * kHeight;
  for (const auto& sampler : test::every_sampler()) {
    const SamplingContext context = test::sampling_context();
    const auto with = sampler.run(whole, budget, context);
    const Needs& needs = sampler.run.needs;
    expect_use(needs.film_positions, with, sampler.run(no_film, budget, context),
               sampler.label() + " without film positions");
    expect_use(needs.features, with, sampler.run(no_features, budget, context),
               sampler.label() + " without features");
    SamplingContext alone = context;
    alone.filter = nullptr;
    const auto without_filter = sampler.run(whole, budget, alone);
    EXPECT_EQ(without_filter.has_value(), !needs.filter_in_loop) << sampler.label();
    if (!needs.filter_in_loop) {
      EXPECT_TRUE(same(*with, *without_filter)) << sampler.label();
    }
    EXPECT_FALSE(needs.reference) << sampler.label() << ": no sampler is handed one";
  }
}

TEST(Needs, OfFiltersAreWhatTheyUse) {
  const SamplePool whole = pool_with(Film::kRecorded, Features::kRecorded);
  const SamplePool no_film = pool_with(Film::kNone, Features::kRecorded);
  const SamplePool no_features = pool_with(Film::kRecorded, Features::kNone);
  const Reference reference = test::mean_of_everything(whole);
  for (const auto& filter : test::every_filter()) {
    FilterContext context;
    context.reference = &reference;
    const auto of = [&](const SamplePool& pool) {
      return filter.run(test::select_uniform(pool, 6), pool, context);
    };
    const Needs& needs = filter.run.needs;
    const auto with = of(whole);
    expect_use(needs.film_positions, with, of(no_film), filter.label() + " without film positions");
    expect_use(needs.features, with, of(no_features), filter.label() + " without features");
    const auto unaided = filter.run(test::select_uniform(whole, 6), whole, FilterContext{});
    EXPECT_EQ(unaided.has_value(), !needs.reference) << filter.label();
    if (!needs.reference) {
      EXPECT_TRUE(same(*with, *unaided)) << filter.label();
    }
    EXPECT_FALSE(needs.filter_in_loop) << filter.label();
    EXPECT_TRUE(needs.samples) << filter.label();
  }
}

TEST(Needs, FollowTheOptionsThatWereChosen) {
  const auto film = [](const std::string& grid) {
    return make_method(filters(), {"greedy_selection", "", {{"grid", grid}}})->needs.film_positions;
  };
  EXPECT_EQ(film("pixel"), Use::kNone);
  EXPECT_EQ(film("auto"), Use::kWhenRecorded);
  EXPECT_EQ(film("subpixel"), Use::kWhenRecorded);
  EXPECT_EQ(make_method(filters(), {"directional", "paper", {}})->needs.film_positions,
            Use::kWhenRecorded);
  EXPECT_EQ(find_method(filters(), "directional")->needs.film_positions, Use::kNone);
}

}  // namespace
}  // namespace spool
