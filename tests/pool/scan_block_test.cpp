#include "lib/pool/scan_block.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "tests/support/memory_pool.h"
#include "tests/support/tiled_recording.h"

namespace spool {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Every kind of number, often next to the limits.
Rgb any_radiance(int x, int y, int s) {
  const float kinds[] = {0.0f,   -0.0f, 1.0f,       -1.0f,      1e-40f, -1e-40f, 1e15f,
                         -1e15f, 1.5f,  2e15f,      -2e15f,     kNaN,   -kNaN,   kInfinity,
                         2.5f,   3.0f,  -kInfinity, 1.5000001f, 0.5f,   7.0f,    0.25f};
  Rgb value{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint64_t draw = mix(5, x, y, s, c);
    value[c] = draw % 16 < 13 ? 0.75f : kinds[(draw >> 8) % std::size(kinds)];
  }
  return value;
}

// The slow twin, sample by sample in the order of rows.
SanitiseReport slow_report(const RecordedSamples& recording, double limit) {
  SanitiseReport report;
  for (int y = 0; y < recording.height(); ++y) {
    for (int x = 0; x < recording.width(); ++x) {
      bool kept = false;
      for (int s = 0; s < recording.spp(); ++s) {
        const Rgb value = recording.raw_radiance(x, y, s);
        ++report.samples;
        if (!is_ordinary(value)) {
          report.add_nonfinite(x, y, s);
          continue;
        }
        kept = true;
        if (value[0] < 0 || value[1] < 0 || value[2] < 0) ++report.negative;
        if (static_cast<double>(std::max({value[0], value[1], value[2]})) > limit) {
          ++report.fireflies;
        }
      }
      report.empty_pixels += kept ? 0 : 1;
    }
  }
  return report;
}

TEST(ScanBlock, CountsWhatItsTwinCounts) {
  for (const int spp : {1, 3, 17}) {
    SanitiseRules rules;
    rules.allow_many_rejected = true;
    const auto whole = test::memory_recording(29, 14, spp, any_radiance, rules);
    for (const double limit :
         {0.0, 0.75, 1.5, 1.50000005, 2.6, 1e15, std::numeric_limits<double>::infinity()}) {
      rules.firefly_limit = limit;
      const auto tiled = test::tiled_recording(*whole, 8, 5, test::Kept::kInPlace, rules);
      ASSERT_NE(tiled, nullptr);
      const SanitiseReport slow = slow_report(*tiled, limit), fast = tiled->report();
      EXPECT_GT(slow.nonfinite, 0u);
      EXPECT_EQ(fast.samples, slow.samples);
      EXPECT_EQ(fast.nonfinite, slow.nonfinite);
      EXPECT_EQ(fast.negative, slow.negative);
      EXPECT_EQ(fast.fireflies, slow.fireflies) << limit;
      EXPECT_EQ(fast.empty_pixels, slow.empty_pixels);
      EXPECT_EQ(fast.first_x, slow.first_x);
      EXPECT_EQ(fast.first_y, slow.first_y);
      EXPECT_EQ(fast.first_sample, slow.first_sample);
    }
  }
}

}  // namespace
}  // namespace spool
