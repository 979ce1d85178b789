#include "lib/pool/sanitise.h"

#include <limits>

#include <gtest/gtest.h>

#include "lib/pool/recorded_samples.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Sanitise, OrdinaryMeansFiniteAndNotBeyondTheLargestRadiance) {
  EXPECT_TRUE(is_ordinary({0.0f, -1.0f, 1e15f}));
  EXPECT_FALSE(is_ordinary({0.0f, 1.1e15f, 0.0f}));
  EXPECT_FALSE(is_ordinary({0.0f, 0.0f, kNaN}));
  EXPECT_FALSE(is_ordinary({-kInfinity, 0.0f, 0.0f}));
}

TEST(Sanitise, DefaultKeepsEveryFiniteValue) {
  const SanitiseRules rules;
  EXPECT_FALSE(rules.changes_values());
  EXPECT_EQ(sanitised({-3.0f, 1e14f, 0.5f}, rules), (Rgb{-3.0f, 1e14f, 0.5f}));
}

TEST(Sanitise, EveryRuleDoesWhatItSays) {
  SanitiseRules rules;
  rules.nonfinite = NonFiniteRule::kZero;
  EXPECT_EQ(sanitised({1.0f, kNaN, 2.0f}, rules), (Rgb{0.0f, 0.0f, 0.0f}));
  rules = {};
  rules.negative = NegativeRule::kClampToZero;
  EXPECT_EQ(sanitised({1.0f, -0.5f, 2.0f}, rules), (Rgb{1.0f, 0.0f, 2.0f}));
  rules = {};
  rules.firefly_limit = 1.5;
  EXPECT_EQ(sanitised({1.0f, -0.5f, 2.0f}, rules), (Rgb{1.0f, -0.5f, 1.5f}));
}

Rgb mixed(int x, int y, int s) {
  if (x == 2 && y == 1 && s == 3) return {kNaN, 0.0f, 0.0f};
  if (x == 3 && y == 1 && s == 0) return {kInfinity, 0.0f, 0.0f};
  if (x == 0 && s == 0) return {-1.0f, 0.0f, 0.0f};
  if (x == 1 && s == 1) return {50.0f, 0.0f, 0.0f};
  return {1.0f, 1.0f, 1.0f};
}

TEST(Sanitise, ReportCountsAndNamesTheFirst) {
  SanitiseRules rules;
  rules.firefly_limit = 10.0;
  rules.negative = NegativeRule::kClampToZero;
  const auto recording = test::memory_recording(20, 10, 4, mixed, rules);
  const SanitiseReport& report = recording->report();
  EXPECT_EQ(report.samples, 800u);
  EXPECT_EQ(report.nonfinite, 2u);
  EXPECT_EQ(report.negative, 10u);
  EXPECT_EQ(report.fireflies, 10u);
  EXPECT_EQ(report.first_x, 2);
  EXPECT_EQ(report.first_y, 1);
  EXPECT_EQ(report.first_sample, 3);
  EXPECT_EQ(recording->guards()[Guard::kRejectedNonFinite], 2u);
  EXPECT_EQ(recording->guards()[Guard::kClampedNegative], 10u);
  EXPECT_EQ(recording->guards()[Guard::kClampedFirefly], 10u);
  EXPECT_EQ(recording->radiance(1, 0, 1)[0], 10.0f);
  EXPECT_TRUE(recording->rejected(2, 1, 3));
  EXPECT_FALSE(recording->rejected(2, 1, 2));
}

Result<RecordedSamples> recording_with(int bad_samples, const SanitiseRules& rules) {
  std::vector<float> values(3 * 10 * 10 * 2, 1.0f);
  for (int i = 0; i < bad_samples; ++i)
    values[static_cast<std::size_t>(i)] = kNaN;  // red of the first samples
  return RecordedSamples::from_memory("made", 10, 10, 2, std::move(values), rules);
}

TEST(Sanitise, MoreThanOnePercentIsRefusedUnlessAllowed) {
  EXPECT_TRUE(recording_with(1, {}).has_value());
  EXPECT_FALSE(recording_with(3, {}).has_value());
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  EXPECT_TRUE(recording_with(3, rules).has_value());
  EXPECT_EQ(recording_with(3, rules)->report().empty_pixels, 1u);
}

TEST(Sanitise, APixelWithoutSamplesIsRefusedUnlessAllowed) {
  const auto refused = recording_with(2, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kData);
  EXPECT_NE(refused.error().message.find("pixel 0,0 sample 0"), std::string::npos);
}

TEST(Sanitise, ErrorRuleRefusesASingleBadSample) {
  SanitiseRules rules;
  rules.nonfinite = NonFiniteRule::kError;
  EXPECT_FALSE(recording_with(1, rules).has_value());
  EXPECT_TRUE(recording_with(0, rules).has_value());
}

TEST(Sanitise, ZeroRuleKeepsThePoolWhole) {
  SanitiseRules rules;
  rules.nonfinite = NonFiniteRule::kZero;
  const auto recording = recording_with(2, rules);
  ASSERT_TRUE(recording.has_value());
  EXPECT_FALSE(recording->any_rejected());
  EXPECT_EQ(recording->radiance(0, 0, 1), (Rgb{0.0f, 0.0f, 0.0f}));
  EXPECT_EQ(recording->guards()[Guard::kZeroedNonFinite], 2u);
}

TEST(Sanitise, OptionsAreReadByName) {
  SanitiseRules rules;
  EXPECT_TRUE(set_option(sanitise_option_table(), rules, "negative", "clamp0").has_value());
  EXPECT_EQ(rules.negative, NegativeRule::kClampToZero);
  EXPECT_FALSE(set_option(sanitise_option_table(), rules, "firefly_limit", "-1").has_value());
}

}  // namespace
}  // namespace spool
