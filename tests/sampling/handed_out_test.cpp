// Samplers that hand a budget out by weights, against their slow twins.
#include <limits>

#include <gtest/gtest.h>

#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/neyman.h"
#include "lib/sampling/rounds.h"
#include "tests/reference/filtered_halves_reference.h"
#include "tests/reference/neyman_reference.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

TEST(FilteredHalves, CountsEqualThoseOfTheSlowTwin) {
  SamplingContext context;
  context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
    GuardCounts guards;
    return pixel_means(selection.statistics, guards);
  };
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const SamplePool pool = test::noisy_pool(width, height, 24);
    for (const int rounds : {1, 4, 7}) {
      for (const double blur : {1.0, 2.0}) {
        FilteredHalvesOptions options;
        options.rounds = rounds;
        options.blur = blur;
        const long long pieces = width * height;
        for (const long long budget : {5 * pieces + 3, 20 * pieces, 23 * pieces + 1}) {
          const auto result = sample_filtered_halves(pool, budget, options, context);
          ASSERT_TRUE(result.has_value());
          const CountImage first = initial_counts(pool, result->log.initial,
                                                  std::numeric_limits<int>::max(), context.seed);
          EXPECT_EQ(result->selection.statistics.n,
                    reference::filtered_halves(
                        pool, first, result->selection.statistics.signal.exposure,
                        budget - result->log.initial, rounds, blur, context.filter))
              << rounds << " rounds, blur " << blur << ", budget " << budget;
        }
      }
    }
  }
}

TEST(Neyman, CountsEqualThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const SamplePool pool = test::noisy_pool(width, height, 24);
    const long long pieces = width * height;
    for (const int each : {1, 3}) {
      NeymanOptions options;
      options.init_spp = each;
      for (const long long budget :
           {each * pieces, 5 * pieces + 3, 20 * pieces, 24 * pieces, 30 * pieces}) {
        const auto result = sample_neyman(pool, budget, options, {});
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(result->selection.statistics.n,
                  reference::neyman(pool, CountImage(width, height, each), budget))
            << each << " first, budget " << budget;
        options.minimise = NeymanTarget::kRelativeError;
        const auto relative = sample_neyman(pool, budget, options, {});
        options.minimise = NeymanTarget::kSquaredError;
        EXPECT_EQ(relative->selection.statistics.n,
                  reference::neyman_relative(pool, CountImage(width, height, each), budget))
            << each << " first, budget " << budget;
      }
    }
  }
}

}  // namespace
}  // namespace spool
