// Several writers of one file, and what killed ones leave.
#include "formats/temporary_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>

#include "formats/dump_check.h"
#include "tests/formats/faulty_calls.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  const fs::directory_iterator all(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

TemporaryFile begun(const fs::path& target, const std::string& text) {
  auto file = TemporaryFile::create(target);
  EXPECT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->file().write_at(0, std::as_bytes(std::span(text))));
  return std::move(*file);
}

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Processes of one id (containers) have no more in common than these two of one process.
TEST(TemporaryFile, TwoOfOneTargetDoNotMeet) {
  const ScratchFolder folder;
  TemporaryFile a = begun(folder / "x", "aaaa"), b = begun(folder / "x", "b");
  EXPECT_NE(a.path(), b.path());
  ASSERT_TRUE(a.publish(Replace::kAnything));
  EXPECT_EQ(text_of(folder / "x"), "aaaa");
  ASSERT_TRUE(b.publish(Replace::kAnything));
  EXPECT_EQ(text_of(folder / "x"), "b");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(TemporaryFile, OneOfTwoWritersWinsAndTheOtherSaysSo) {
  for (const bool replaces : {false, true}) {
    const ScratchFolder folder;
    if (replaces) {
      ASSERT_TRUE(begun(folder / "x", "old").publish(Replace::kNothing));
    }
    const Replace how = replaces ? Replace::kWhatWasHere : Replace::kNothing;
    {
      TemporaryFile a = begun(folder / "x", "a"), b = begun(folder / "x", "b");
      ASSERT_TRUE(a.publish(how));
      const auto slower = b.publish(how);
      ASSERT_FALSE(slower);
      EXPECT_EQ(slower.error().code, ErrorCode::kIo);
      EXPECT_NE(slower.error().message.find("another process"), std::string::npos);
    }
    EXPECT_EQ(text_of(folder / "x"), "a");
    EXPECT_EQ(files_in(folder.path()), 1u);
  }
}

TEST(TemporaryFile, LongNamesAndFoldersThatAreNotThere) {
  const ScratchFolder folder;
  const fs::path target = folder.path() / std::string(255, 'n');
  ASSERT_TRUE(begun(target, "long").publish(Replace::kNothing));
  EXPECT_EQ(text_of(target), "long");
  const auto none = TemporaryFile::create(folder / "none/x");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kIo);
  EXPECT_TRUE(none.error().message.starts_with((folder / "none/x").string() + ":"));
}

TEST(TemporaryFile, OnlyWhatDeadWritersLeftIsSwept) {
  const ScratchFolder folder;
  TemporaryFile alive = begun(folder / "alive", "a");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    TemporaryFile dead = begun(folder / "dead", "d");
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  // Names that are not quite of that kind belong to somebody else.
  for (const char* name : {"x.partial", "x.spool-abc.partial", ".spool-abcdefgh.partial"})
    std::ofstream(folder / name) << "mine";
  fs::create_symlink("x.partial", folder / "link.spool-abcdefgh.partial");
  ASSERT_EQ(files_in(folder.path()), 6u);
  EXPECT_EQ(sweep_temporary_files(folder.path(), std::chrono::hours(1)), 0u);
  EXPECT_EQ(sweep_temporary_files(folder.path()), 1u);
  EXPECT_EQ(files_in(folder.path()), 5u);
  ASSERT_TRUE(alive.publish(Replace::kNothing));
  EXPECT_EQ(text_of(folder / "alive"), "a");
}

TEST(TemporaryFile, OneThatWasSweptByMistakeSaysSoAndChangesNothing) {
  const ScratchFolder folder;
  TemporaryFile file = begun(folder / "x", "a");
  fs::remove(file.path());
  const auto published = file.publish(Replace::kAnything);
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().code, ErrorCode::kIo);
  EXPECT_FALSE(fs::exists(folder / "x"));
}

TEST(SpoolWriter, ADiscardedDumpLeavesNothingAndAPublishedOneIsWhole) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(4, 3, 2, 1);
  dump.options.discard_unfinished = true;
  {
    auto writer = SpoolWriter::create(folder / "a.spool", dump.header, dump.options);
    ASSERT_TRUE(writer);
    EXPECT_TRUE(fs::exists(folder / "a.spool.remade.partial"));
  }
  EXPECT_EQ(files_in(folder.path()), 0u);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  EXPECT_TRUE(check_dump(folder / "a.spool")->complete);
  EXPECT_EQ(files_in(folder.path()), 1u);
}

// A second writer opens NAME.partial, its first writer finishes, the second one gets the lock: of a
// file that is NAME by now, and must not be emptied.
fs::path* finished_meanwhile = nullptr;

TEST(SpoolWriter, AFileThatWasFinishedMeanwhileIsNotTouched) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(4, 3, 2, 1);
  fs::path name = folder / "a.spool";
  ASSERT_TRUE(make_dump(name, dump));
  fs::rename(name, folder / "a.spool.partial");  // sealed, and not yet renamed
  finished_meanwhile = &name;
  FileCalls calls = posix_calls();
  calls.lock = [](int descriptor) {
    fs::rename(finished_meanwhile->string() + ".partial", *finished_meanwhile);
    return posix_calls().lock(descriptor);
  };
  replace_file_calls(calls);
  const auto second = SpoolWriter::create(name, dump.header, {.force = true});
  replace_file_calls(posix_calls());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kIo);
  EXPECT_TRUE(check_dump(name)->complete);
}

}  // namespace
}  // namespace spool::format
