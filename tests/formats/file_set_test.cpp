// Sets of files: whole or not at all, also where the system does not rename one of them.
#include "formats/file_set.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/formats/faulty_calls.h"
#include "tests/support/scratch_folder.h"

namespace spool::format {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

// "a" and "b" of a set anew; "c" is of the earlier one alone.
Result<void> write_set(const fs::path& folder) {
  SPOOL_ASSIGN(FileSet set, FileSet::create(folder, {"a", "b", "c"}, true, {}));
  for (const std::string name : {"b", "a"})
    SPOOL_TRY(set.write(name, [&](const fs::path& path) -> Result<void> {
      put(path, "new " + name);
      return {};
    }));
  return set.publish();
}

TEST(FileSet, ReplacesAnEarlierSetWhole) {
  const ScratchFolder folder;
  for (const char* name : {"a", "b", "c", "d"})
    put(folder / name, "old");
  const auto written = write_set(folder.path());
  ASSERT_TRUE(written.has_value()) << written.error().message;
  EXPECT_EQ(text_of(folder / "a"), "new a");
  EXPECT_EQ(text_of(folder / "b"), "new b");
  EXPECT_FALSE(fs::exists(folder / "c"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);  // d is of nobody here
}

TEST(FileSet, TheEarlierSetComesBackWhereARenameFails) {
  for (std::uint64_t rename = 1; rename <= 5; ++rename) {  // three away, two in their place
    const ScratchFolder folder;
    for (const char* name : {"a", "b", "c"})
      put(folder / name, "old");
    const FaultyCalls faults({.call = Call::kRename, .fail_at = rename});
    const auto written = write_set(folder.path());
    ASSERT_TRUE(faults.struck()) << rename;
    ASSERT_FALSE(written.has_value()) << rename;
    EXPECT_EQ(written.error().code, ErrorCode::kIo);
    for (const char* name : {"a", "b", "c"})
      EXPECT_EQ(text_of(folder / name), "old") << rename;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3) << rename;
  }
}

TEST(FileSet, WhatCannotBePutBackIsKept) {
  const ScratchFolder folder;
  for (const char* name : {"a", "b", "c"})
    put(folder / name, "old");
  const FaultyCalls faults({.call = Call::kRename, .fail_at = 4, .for_ever = true});
  ASSERT_FALSE(write_set(folder.path()).has_value());
  int kept = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
    kept += entry.is_regular_file() && text_of(entry.path()) == "old";
  EXPECT_EQ(kept, 3);
}

TEST(FileSet, IsRefusedWhereOneIsThereOrWasWrittenMeanwhile) {
  const ScratchFolder folder;
  put(folder / "b", "old");
  EXPECT_EQ(FileSet::create(folder.path(), {"a", "b"}, false, {}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(FileSet::create(folder.path(), {"a", "b"}, true, {folder / "b"}).error().code,
            ErrorCode::kUsage);
  auto set = FileSet::create(folder.path(), {"a", "b"}, true, {});
  ASSERT_TRUE(set.has_value());
  put(folder / "a", "of another process");
  EXPECT_EQ(set->publish().error().code, ErrorCode::kIo);
  EXPECT_EQ(text_of(folder / "a"), "of another process");
  EXPECT_EQ(text_of(folder / "b"), "old");
}

}  // namespace
}  // namespace spool::format
