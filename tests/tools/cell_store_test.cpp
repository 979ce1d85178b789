#include "tools/batch/cell_store.h"

#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "lib/experiment/plan_cells.h"
#include "lib/experiment/result_table.h"
#include "tests/support/scratch_folder.h"
#include "tools/batch/cell_text.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

ResultRecord record_of(const std::string& mse, const std::string& error = "") {
  ResultRecord record;
  record.fields.resize(result_columns().size());
  record.fields[column_index("mse")] = mse;
  record.fields[column_index("error")] = error;
  record.counts = {{4, 90}, {5, 10}};
  return record;
}

std::string mse_in(const CellStore& store, std::uint64_t number) {
  const auto record = store.read(cell_id(number), Cell{});
  return record ? record->text("mse") : record.error().message;
}

CellStore opened(const fs::path& folder) {
  auto store = CellStore::open(folder);
  EXPECT_TRUE(store.has_value()) << store.error().message;
  return std::move(*store);
}

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(CellLine, AnyByteThatChangesIsNoticed) {
  const std::string line = cell_line(0x0123456789abcdefULL, record_of("0.25"));
  const auto whole = checked_line(line);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->number, 0x0123456789abcdefULL);
  EXPECT_FALSE(whole->failed);
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string changed = line;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    EXPECT_FALSE(checked_line(changed).has_value()) << changed;
    EXPECT_FALSE(checked_line(line.substr(0, i)).has_value()) << i;
  }
  EXPECT_TRUE(checked_line(cell_line(7, record_of("", "no samples")))->failed);
}

TEST(CellStore, WhatIsWrittenIsReadByTheNextOne) {
  const test::ScratchFolder scratch;
  ASSERT_FALSE(CellStore::is_in(scratch.path()));
  ASSERT_TRUE(opened(scratch.path()).empty());
  ASSERT_TRUE(CellStore::create(scratch.path()).has_value());
  for (const char* mse : {"1", "2"}) {  // two processes, the second of which does a cell anew
    CellStore store = opened(scratch.path());
    ASSERT_TRUE(store.write(cell_id(1), record_of(mse, mse[0] == '1' ? "failed" : "")).has_value());
    ASSERT_TRUE(store.write(cell_id(mse[0]), record_of(mse)).has_value());
    ASSERT_TRUE(store.sync().has_value());
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path() / "cells"), {}), 2);
  const CellStore store = opened(scratch.path());
  EXPECT_EQ(mse_in(store, 1), "2");
  EXPECT_EQ(mse_in(store, '1'), "1");
  EXPECT_EQ(mse_in(store, '2'), "2");
  EXPECT_EQ(store.read(cell_id(1), Cell{})->counts, record_of("").counts);
  EXPECT_EQ(store.read(cell_id(5), Cell{}).error().code, ErrorCode::kIo);
  EXPECT_EQ(store.count_others([](const std::string& id) { return id == cell_id(1); }), 2u);
}

TEST(CellStore, AFailureDoesNotReplaceAResultAndOfTwoTheLastCounts) {
  const test::ScratchFolder scratch;
  ASSERT_TRUE(CellStore::create(scratch.path()).has_value());
  const fs::path cells = scratch.path() / "cells";
  write(cells / "a.jsonl",
        cell_line(1, record_of("1")) + "\n" + cell_line(2, record_of("2")) + "\n");
  write(cells / "b.jsonl",
        cell_line(1, record_of("", "failed")) + "\n" + cell_line(2, record_of("3")) + "\n");
  const CellStore store = opened(scratch.path());
  EXPECT_EQ(mse_in(store, 1), "1");
  EXPECT_EQ(mse_in(store, 2), "3");
}

TEST(CellStore, DamageIsCountedAndALineThatWasCutIsNot) {
  const test::ScratchFolder scratch;
  ASSERT_TRUE(CellStore::create(scratch.path()).has_value());
  const std::string first = cell_line(1, record_of("1")), last = cell_line(3, record_of("3"));
  std::string damaged = cell_line(2, record_of("2"));
  damaged[damaged.size() - 4] ^= 4;
  write(scratch.path() / "cells" / "a.jsonl", first + "\n" + damaged + "\n" + last);
  const CellStore store = opened(scratch.path());
  EXPECT_EQ(store.damaged(), 1u);
  EXPECT_EQ(store.damage(), "1 damaged results count as missing; the first: " +
                                (scratch.path() / "cells" / "a.jsonl").string() + ", line 2");
  EXPECT_EQ(mse_in(store, 1), "1");
  EXPECT_FALSE(store.read(cell_id(2), Cell{}).has_value());
  EXPECT_FALSE(store.read(cell_id(3), Cell{}).has_value());
}

TEST(CellStore, TakesWhatIsMissingOrFailedHereOnce) {
  const test::ScratchFolder here, there;
  for (const auto& folder : {here.path(), there.path()})
    ASSERT_TRUE(CellStore::create(folder).has_value());
  write(here.path() / "cells" / "a.jsonl",
        cell_line(1, record_of("1")) + "\n" + cell_line(2, record_of("", "failed")) + "\n");
  std::string lines;
  for (const std::uint64_t number : {3, 2, 1})
    lines += cell_line(number, record_of("9")) + "\n";
  write(there.path() / "cells" / "b.jsonl", lines);
  for (int turn = 0; turn < 2; ++turn) {
    CellStore store = opened(here.path());
    ASSERT_TRUE(store.take_from(opened(there.path())).has_value());
  }
  const CellStore store = opened(here.path());
  EXPECT_EQ(mse_in(store, 1), "1");
  EXPECT_EQ(mse_in(store, 2), "9");
  EXPECT_EQ(mse_in(store, 3), "9");
  EXPECT_EQ(std::distance(fs::directory_iterator(here.path() / "cells"), {}), 2);
}

}  // namespace
}  // namespace spool::tools
