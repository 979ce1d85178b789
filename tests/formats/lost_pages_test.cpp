#include "formats/lost_pages.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "formats/spool_reader.h"
#include "formats/spool_writer.h"
#include "tests/support/scratch_folder.h"

namespace spool::format {
namespace {

using test::ScratchFolder;

// Four blocks of 64 KiB of ones.
void write_ones(const std::filesystem::path& path) {
  DumpHeader header;
  header.width = header.height = 32;
  header.tile_size = 32;
  header.spp = 32;
  header.block_spp = 8;
  header.channels = radiance_channels();
  auto writer = SpoolWriter::create(path, header, {});
  ASSERT_TRUE(writer.has_value());
  const std::vector<float> ones(3 * 32 * 32 * 8, 1.0f);
  for (uint32_t block = 0; block < 4; ++block)
    ASSERT_TRUE(writer->write_block(0, 0, 8 * block, 8, std::as_bytes(std::span(ones))));
  ASSERT_TRUE(writer->finish());
}

double sum_of(std::span<const std::byte> bytes) {
  double sum = 0.0;
  for (size_t i = 0; i < bytes.size() / sizeof(float); ++i)
    sum += static_cast<double>(reinterpret_cast<const float*>(bytes.data())[i]);
  return sum;
}

TEST(LostPages, AreZerosAndAnErrorAfterTheFileWasCut) {
  survive_lost_pages();
  const ScratchFolder folder;
  write_ones(folder / "a.spool");
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_TRUE(reader.has_value());
  std::vector<std::span<const std::byte>> blocks;
  for (uint32_t block = 0; block < 3; ++block) {
    const auto mapped = reader->map_block(0, 0, block);
    ASSERT_TRUE(mapped.has_value());
    blocks.push_back(*mapped);
  }
  EXPECT_EQ(sum_of(blocks[2]), 3.0 * 32 * 32 * 8);
  EXPECT_TRUE(reader->intact().has_value());
  ASSERT_EQ(::truncate((folder / "a.spool").c_str(), 4096), 0);
  // Several threads meet the same lost pages.
  std::vector<double> sums(4, -1.0);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < sums.size(); ++i)
    threads.emplace_back([&, i] { sums[i] = sum_of(blocks[2]); });
  for (std::thread& thread : threads)
    thread.join();
  for (const double sum : sums)
    EXPECT_EQ(sum, 0.0);
  const auto intact = reader->intact();
  ASSERT_FALSE(intact.has_value());
  EXPECT_EQ(intact.error().code, ErrorCode::kDamage);
  EXPECT_NE(intact.error().message.find("a.spool"), std::string::npos);
  // A block that is looked at for the first time says the same, not that its checksum is wrong.
  const auto later = reader->map_block(0, 0, 3);
  ASSERT_FALSE(later.has_value());
  EXPECT_EQ(later.error().message, intact.error().message);
}

TEST(LostPages, OtherReadersAreNotConcerned) {
  survive_lost_pages();
  const ScratchFolder folder;
  write_ones(folder / "a.spool");
  write_ones(folder / "b.spool");
  const auto cut = SpoolReader::open(folder / "a.spool");
  const auto whole = SpoolReader::open(folder / "b.spool");
  ASSERT_TRUE(cut && whole);
  const auto lost = cut->map_block(0, 0, 0), kept = whole->map_block(0, 0, 0);
  ASSERT_TRUE(lost && kept);
  ASSERT_EQ(::truncate((folder / "a.spool").c_str(), 0), 0);
  EXPECT_EQ(sum_of(*lost), 0.0);
  EXPECT_GT(sum_of(*kept), 0.0);
  EXPECT_TRUE(whole->intact().has_value());
}

TEST(LostPages, MoreMappingsThanCanBeWatchedStillWork) {
  std::vector<int> ranges;
  std::vector<char> memory(1);
  for (int i = 0; i < kMaxWatchedRanges + 10; ++i)
    ranges.push_back(watch_range(memory.data(), memory.size()));
  EXPECT_EQ(ranges.back(), -1);
  EXPECT_FALSE(lost_pages(ranges.back()));
  for (const int range : ranges)
    forget_range(range);
  const int again = watch_range(memory.data(), memory.size());
  EXPECT_GE(again, 0);
  forget_range(again);
}

void raise_bus_error() {
  survive_lost_pages();
  const ::rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::raise(SIGBUS);
  ::raise(SIGBUS);
}

// What is no mapping of ours ends the process as before.
TEST(LostPagesDeathTest, AnotherBusErrorStaysFatal) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(raise_bus_error(), ::testing::KilledBySignal(SIGBUS), "");
}

}  // namespace
}  // namespace spool::format
