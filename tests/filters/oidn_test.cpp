// What Open Image Denoise is handed, and what happens where it is not there.
// tests/tools/test_oidn.py runs the library itself.
#include "lib/filters/oidn/oidn.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/every_method.h"
#include "tests/support/memory_pool.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWidth = 7, kHeight = 5, kSamples = 4;
constexpr float kAlbedo = 0.5f, kNormal = -0.75f;

class Oidn : public ::testing::Test {
 protected:
  void SetUp() override { use(SPOOL_OIDN_STUB_2); }
  void TearDown() override {
    ::unsetenv("SPOOL_OIDN");
    ::unsetenv("SPOOL_OIDN_STUB");
  }
  static void use(const char* library) { ::setenv("SPOOL_OIDN", library, 1); }
};

SamplePool pool_with(const std::vector<std::string>& layers, float factor = 1.0f) {
  auto recording = std::make_shared<RecordedSamples>(
      *test::memory_recording(kWidth, kHeight, kSamples, [=](int x, int y, int s) {
        const auto v = static_cast<float>(0.5 + unit_double(mix(3, x, y, s)));
        return Rgb{factor * v, factor * 2 * v, factor * 0.5f * v};
      }));
  std::vector<FeatureLayer> features;
  for (const std::string& name : layers)
    features.push_back({name, name == "normal" ? "XYZ" : "RGB"});
  recording->set_features(features, [](const FeatureLayer& layer, const Rectangle& pixels, int n) {
    const float value = layer.name == "normal" ? kNormal : kAlbedo;
    return Result<std::vector<float>>(
        std::vector<float>(static_cast<std::size_t>(3 * pixels.area() * n), value));
  });
  return test::pool_of(recording);
}

Result<Reconstruction> run(const SamplePool& pool, const OptionValues& set) {
  SPOOL_ASSIGN(const ReadyFilter filter, oidn_filter().make("", set));
  return filter(test::select_uniform(pool, kSamples), pool, FilterContext{});
}

// The mean luminance is in [1, 2): radiance is handed over as it is.
void expect_added(const SamplePool& pool, const OptionValues& set, double added) {
  const auto result = run(pool, set);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  GuardCounts guards;
  const RgbImage mean = pixel_means(test::select_uniform(pool, kSamples).statistics, guards);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < mean[c].size(); ++i)
      EXPECT_NEAR(result->image[c][i], mean[c][i] + added, 1e-4);
  }
}

TEST_F(Oidn, SeesRadianceWithoutALimitAndFeaturesThatWereDenoisedByThemselves) {
  const SamplePool pool = pool_with({"albedo", "normal"});
  const double features = 0.25 * kAlbedo + 0.0625 * kNormal;
  expect_added(pool, {}, 0.5 * features + 128.0);
  expect_added(pool, {{"prefilter", "off"}}, features);
  expect_added(pool, {{"features", "albedo"}}, 0.5 * 0.25 * kAlbedo + 128.0);
  expect_added(pool, {{"features", "off"}}, 0.0);
}

TEST_F(Oidn, TakesWhatWasRecorded) {
  expect_added(pool_with({}), {}, 0.0);
  expect_added(pool_with({"albedo"}), {{"prefilter", "off"}}, 0.25 * kAlbedo);
  expect_added(pool_with({"normal"}), {}, 0.0);  // the library wants an albedo beside it
}

TEST_F(Oidn, CallsVersion1ByItsNames) {
  use(SPOOL_OIDN_STUB_1);
  expect_added(pool_with({"albedo"}), {{"prefilter", "off"}}, 0.25 * kAlbedo);
}

TEST_F(Oidn, GivesTheSameDigitsInAnyUnit) {
  const auto one = run(pool_with({}), {});
  for (const int power : {-30, -1, 3, 30}) {
    const auto scaled = run(pool_with({}, std::ldexp(1.0f, power)), {});
    ASSERT_TRUE(one.has_value() && scaled.has_value());
    for (std::size_t i = 0; i < one->image[1].size(); ++i)
      EXPECT_EQ(scaled->image[1][i], std::ldexp(one->image[1][i], power)) << power;
  }
}

TEST_F(Oidn, NotesLightThatTheNetworkLost) {
  const auto all = run(pool_with({}), {});
  ::setenv("SPOOL_OIDN_STUB", "dim", 1);
  const auto some = run(pool_with({}), {});
  ASSERT_TRUE(all.has_value() && some.has_value());
  EXPECT_TRUE(all->notes.empty());
  ASSERT_EQ(some->notes.size(), 1u);
  EXPECT_THAT(some->notes[0], AllOf(HasSubstr("96.9 %"), HasSubstr("energy=box")));
}

TEST_F(Oidn, IsRefusedWhereTheLibraryIsMissing) {
  for (const char* place : {"/nowhere/libOpenImageDenoise.so", "/"}) {
    use(place);
    const auto missing = oidn_filter().make("", {})->installed();
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(missing.error().code, ErrorCode::kUsage);
    EXPECT_THAT(missing.error().message,
                AllOf(HasSubstr("Open Image Denoise"), HasSubstr("not here"),
                      HasSubstr("SPOOL_OIDN"), HasSubstr("pyoidn"), Not(HasSubstr("\n"))));
  }
  use("libm.so.6");
  const auto other = oidn_filter().make("", {})->installed();
  ASSERT_FALSE(other.has_value());
  EXPECT_THAT(other.error().message, HasSubstr("has no function oidnNewDevice"));
}

TEST_F(Oidn, HandsOnWhatTheLibrarySays) {
  ::setenv("SPOOL_OIDN_STUB", "fail", 1);
  const auto result = run(pool_with({"albedo"}), {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_THAT(result.error().message, HasSubstr("out of patience"));
}

TEST_F(Oidn, RefusesASelectionWithoutSamples) {
  const SamplePool pool = pool_with({});
  const auto made = oidn_filter().make("", {});
  ASSERT_TRUE(made.has_value()) << made.error().message;
  const auto result = (*made)(test::select_uniform(pool, 0), pool, FilterContext{});
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().message, HasSubstr("no piece has a sample"));
}

}  // namespace
}  // namespace spool
