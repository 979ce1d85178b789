#include "lib/pool/block_cache.h"

#include <atomic>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/core/random.h"
#include "tests/support/memory_pool.h"
#include "tests/support/tiled_recording.h"

namespace spool {
namespace {

using test::Kept;

// Eight blocks of 8 x 8 pixels, 2 samples and 3 channels of floats.
constexpr LayerGrid kGrid{16, 16, 4, 8, 2};
constexpr std::uint64_t kBlockBytes = 8 * 8 * 2 * 3 * sizeof(float);

struct Counted {
  std::shared_ptr<std::atomic<int>> reads = std::make_shared<std::atomic<int>>(0);
  std::shared_ptr<const RecordedSamples> whole =
      test::memory_recording(16, 16, 4, [](int x, int y, int s) -> Rgb {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(s)};
      });
  BlockReader reader(Kept kept = Kept::kReadAgain) const {
    return [reads = reads,
            blocks = test::reader_of(test::cut_blocks(*whole, kGrid), kept)](std::size_t i) {
      ++*reads;
      return blocks(i);
    };
  }
};

TEST(BlockCache, KeepsWhatWasAskedForLast) {
  const Counted counted;
  const BlockReader cache = cached_blocks(counted.reader(), kGrid, 3, 2 * kBlockBytes);
  for (const std::size_t i : {0, 1, 0, 1})
    ASSERT_TRUE(cache(i).has_value());
  EXPECT_EQ(*counted.reads, 2);
  ASSERT_TRUE(cache(2).has_value());  // in the place of 0
  ASSERT_TRUE(cache(1).has_value());
  EXPECT_EQ(*counted.reads, 3);
  ASSERT_TRUE(cache(0).has_value());
  EXPECT_EQ(*counted.reads, 4);
}

TEST(BlockCache, LetsGoOfWhatItHasNoRoomFor) {
  const Counted counted;
  const BlockReader cache = cached_blocks(counted.reader(), kGrid, 3, kBlockBytes);
  std::weak_ptr<const void> first = cache(0)->held;
  EXPECT_FALSE(first.expired());
  ASSERT_TRUE(cache(1).has_value());
  EXPECT_TRUE(first.expired());
}

TEST(BlockCache, OneBlockIsNeverTooMany) {
  const Counted counted;
  const BlockReader cache = cached_blocks(counted.reader(), kGrid, 3, 1);
  ASSERT_TRUE(cache(3).has_value());
  ASSERT_TRUE(cache(3).has_value());
  EXPECT_EQ(*counted.reads, 1);
}

TEST(BlockCache, DoesNotKeepErrors) {
  int reads = 0;
  const BlockReader cache = cached_blocks(
      [&](std::size_t) -> Result<BlockValues> {
        ++reads;
        return fail(ErrorCode::kIo, "no");
      },
      kGrid, 3, kBlockBytes);
  EXPECT_FALSE(cache(0).has_value());
  EXPECT_FALSE(cache(0).has_value());
  EXPECT_EQ(reads, 2);
}

TEST(BlockCache, GivesTheSameFromAnyNumberOfThreads) {
  const Counted counted;
  LayerBlocks layer(kGrid, 3, cached_blocks(counted.reader(), kGrid, 3, 3 * kBlockBytes));
  ASSERT_TRUE(layer.read_all({}, [](const BlockView&) { return Result<void>(); }).has_value());
  EXPECT_FALSE(layer.in_place());
  std::atomic<int> wrong{0};
  parallel_for(20000, [&](std::size_t i) {
    const int x = static_cast<int>(mix(1, i) % 16), y = static_cast<int>(mix(2, i) % 16),
              s = static_cast<int>(mix(3, i) % 4);
    const LayerBlocks::Place place = layer.place_of(x, y, s);
    wrong += place.value[0] != static_cast<float>(x) ||
             place.value[place.channel] != static_cast<float>(y) ||
             place.value[2 * place.channel] != static_cast<float>(s);
  });
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace spool
