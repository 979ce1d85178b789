#include "lib/core/available_memory.h"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

namespace spool {
namespace {

namespace fs = std::filesystem;

class MemoryLeftInGroups : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << text;
  }

  fs::path folder_;
};

TEST_F(MemoryLeftInGroups, IsTheLeastOfAGroupAndItsParentsCacheNotCounted) {
  write("a/b/memory.max", "5000\n");
  write("a/b/memory.current", "1200\n");
  write("a/b/memory.stat", "anon 700\ninactive_file 500\n");
  EXPECT_EQ(memory_left_in_groups("0::/a/b\n", folder_), 4300u);
  write("a/memory.max", "4000\n");
  write("a/memory.current", "1000\n");
  EXPECT_EQ(memory_left_in_groups("0::/a/b\n", folder_), 3000u);
}

TEST_F(MemoryLeftInGroups, OfVersion1TakesTheMemoryController) {
  write("memory/x/memory.limit_in_bytes", "9000\n");
  write("memory/x/memory.usage_in_bytes", "8000\n");
  write("memory/x/memory.stat",
        "inactive_file 1\ntotal_inactive_file 4000\ntotal_active_file 2000\n");
  EXPECT_EQ(memory_left_in_groups("11:cpuset:/y\n4:memory:/x\n", folder_), 7000u);
}

TEST_F(MemoryLeftInGroups, IsNothingWhereTheGroupIsOverItsLimit) {
  write("memory.max", "1000\n");
  write("memory.current", "1500\n");
  EXPECT_EQ(memory_left_in_groups("0::/of/the/host\n", folder_), 0u);
}

TEST_F(MemoryLeftInGroups, IsUnknownWithoutALimit) {
  write("memory.max", "max\n");
  write("memory.current", "1500\n");
  EXPECT_FALSE(memory_left_in_groups("0::/\n", folder_).has_value());
  EXPECT_FALSE(memory_left_in_groups("", folder_).has_value());
}

TEST(MemoryLimit, IsANumberOfBytesOrRefused) {
  for (const char* bytes : {"", "0", "4000000000", "18446744073709551615"}) {
    ::setenv("SPOOL_MEMORY", bytes, 1);
    EXPECT_TRUE(check_memory_limit().has_value()) << bytes;
  }
  for (const char* text : {"4GB", "1e9", "-1", " 5", "nan", "18446744073709551616"}) {
    ::setenv("SPOOL_MEMORY", text, 1);
    const Result<void> checked = check_memory_limit();
    ASSERT_FALSE(checked.has_value()) << text;
    EXPECT_EQ(checked.error().code, ErrorCode::kUsage);
    EXPECT_NE(checked.error().message.find(text), std::string::npos);
  }
  ::unsetenv("SPOOL_MEMORY");
}

}  // namespace
}  // namespace spool
