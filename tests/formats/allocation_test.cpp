// X1, memory: the k-th allocation fails, for every k of a small job. What is left is a valid
// partial file or an untouched target, and the next try succeeds.
#include <gtest/gtest.h>

#include <atomic>
#include <new>

#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/made_dump.h"

namespace {

std::atomic<long> allocations_left{-1};  // negative: all succeed

bool strikes() {
  if (allocations_left.load() < 0) return false;
  return allocations_left.fetch_sub(1) == 0;
}

}  // namespace

// The tests' own new: counts, and fails once. Not inlined, or g++ 12 takes free() for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  if (strikes()) throw std::bad_alloc();
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace spool::format {
namespace {

// Runs `job` with its k-th allocation failing; false when it was over before.
template <class Job>
bool fails_at(long k, Job&& job) {
  bool struck = false;
  allocations_left = k;
  try {
    job();
  } catch (const std::bad_alloc&) {
  }
  struck = allocations_left.load() < 0;
  allocations_left = -1;
  return struck;
}

MadeDump small_job() {
  MadeDump dump;
  dump.header = small_header(9, 3, 3, 2);
  dump.meta = {R"({"seed":1})"};
  dump.options.force = true;
  return dump;
}

TEST(AllocationFailure, LeavesAWriterRecoverable) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  const MadeDump dump = small_job();
  ASSERT_TRUE(make_dump(path, dump));
  const Bytes expected = read_bytes(path);
  long k = 0;
  for (; k < 100000; ++k) {
    std::filesystem::remove(path);
    std::filesystem::remove(folder / "a.spool.partial");
    const bool struck = fails_at(k, [&] { static_cast<void>(make_dump(path, dump)); });
    if (std::filesystem::exists(path)) {
      ASSERT_TRUE(check_dump(path)->complete) << k;
    }
    ASSERT_TRUE(make_dump(path, dump)) << k;
    ASSERT_EQ(read_bytes(path), expected);
    if (!struck) break;
  }
  EXPECT_GT(k, 20);
}

TEST(AllocationFailure, LeavesReadersAndRecoveryWithoutHarm) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool", out = folder / "b.spool";
  ASSERT_TRUE(make_dump(path, rich_dump(true)));
  const Bytes before = read_bytes(path);
  const auto read = [&] {
    const auto reader = SpoolReader::open(path);
    if (!reader) return;
    static_cast<void>(reader->read_region("radiance", {0, 0, 9, 5}, 0, 3));
    static_cast<void>(reader->read_pixel_layer("reference"));
    static_cast<void>(check_dump(path));
  };
  long k = 0;
  while (k < 100000 && fails_at(k, read))
    ++k;
  EXPECT_GT(k, 20);
  write_bytes(out, Bytes(10, std::byte{3}));
  long r = 0;
  for (; r < 100000; ++r) {
    std::filesystem::remove(folder / "b.spool.partial");
    const bool struck = fails_at(r, [&] { static_cast<void>(recover_dump(path, out, true)); });
    const Bytes now = read_bytes(out);
    ASSERT_TRUE(now == Bytes(10, std::byte{3}) || check_dump(out)->intact()) << r;
    if (!struck) break;
  }
  EXPECT_GT(r, 20);
  EXPECT_EQ(read_bytes(path), before);
}

}  // namespace
}  // namespace spool::format
