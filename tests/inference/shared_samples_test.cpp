#include "lib/inference/shared_samples.h"

#include <set>

#include <gtest/gtest.h>

#include "lib/core/radical_inverse.h"
#include "lib/core/random.h"

namespace spool {
namespace {

using Counts = std::vector<std::pair<int, long long>>;

TEST(RadicalInverse, HalvesTheGapsInTurn) {
  const double first[] = {0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875};
  for (unsigned i = 0; i < 8; ++i)
    EXPECT_EQ(radical_inverse(i), first[i]);
}

TEST(SharedShare, IsNoneWhereReplicatesFitInBesideEachOther) {
  EXPECT_EQ(shared_share(Counts{{8, 100}}, 64, 8, Taking::kOneAround), 0.0);
  EXPECT_EQ(shared_share(Counts{{8, 100}}, 64, 1, Taking::kOwnOrder), 0.0);
  EXPECT_GT(shared_share(Counts{{9, 100}}, 64, 8, Taking::kOneAround), 0.0);
}

TEST(SharedShare, OfOwnOrdersIsTheShareTaken) {
  EXPECT_DOUBLE_EQ(shared_share(Counts{{16, 100}}, 64, 8, Taking::kOwnOrder), 0.25);
  // Every pixel that was sampled counts once, however many samples it took.
  EXPECT_DOUBLE_EQ(shared_share(Counts{{0, 5}, {4, 3}, {64, 1}}, 64, 8, Taking::kOwnOrder),
                   (3 * 4.0 / 64 + 1.0) / 4.0);
}

// Places on a ring, counted one by one.
TEST(SharedShare, OfARingAgreesWithCounting) {
  for (const int replicates : {2, 3, 5, 8}) {
    for (const int count : {3, 16, 20, 40, 64}) {
      double shared = 0.0;
      for (int r = 0; r < replicates; ++r) {
        for (int s = 0; s < r; ++s) {
          std::set<int> first;
          for (int i = 0; i < count; ++i)
            first.insert((static_cast<int>(64 * radical_inverse(static_cast<unsigned>(r))) + i) %
                         64);
          int common = 0;
          for (int i = 0; i < count; ++i)
            common += static_cast<int>(first.count(
                (static_cast<int>(64 * radical_inverse(static_cast<unsigned>(s))) + i) % 64));
          shared += static_cast<double>(common) / count / (0.5 * replicates * (replicates - 1));
        }
      }
      EXPECT_NEAR(shared_share(Counts{{count, 7}}, 64, replicates, Taking::kOneAround), shared,
                  1e-12)
          << replicates << " of " << count;
    }
  }
}

TEST(SharedShare, OfSeveralRecordingsIsDiluted) {
  EXPECT_DOUBLE_EQ(over_recordings(0.3, 4, 1), 0.3);
  EXPECT_DOUBLE_EQ(over_recordings(0.3, 4, 2), 0.3 * 3 / 7);
  EXPECT_EQ(over_recordings(0.3, 1, 1), 0.0);
}

}  // namespace
}  // namespace spool
