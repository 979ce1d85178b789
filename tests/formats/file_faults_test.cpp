// The system refuses, stutters, fills up or kills: a clean error, and nothing worse than a partial
// file.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/crc_repair.h"
#include "tests/formats/faulty_calls.h"
#include "tests/formats/made_dump.h"
#include "tests/support/trust.h"

namespace spool::format {
namespace {

MadeDump small_dump() {
  MadeDump dump;
  dump.header = small_header(9, 3, 3, 2);
  add_group(dump.header, {"film.X", "film.Y"}, DataType::kFloat32, Scope::kPass);
  dump.meta = {R"({"seed":1})"};
  return dump;
}

// The bytes the small dump must have.
Bytes true_bytes() {
  const ScratchFolder folder;
  EXPECT_TRUE(make_dump(folder / "true.spool", small_dump()));
  return read_bytes(folder / "true.spool");
}

Result<void> resume_dump(const std::filesystem::path& path, const MadeDump& dump) {
  SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::resume(path, dump.options));
  if (writer.meta_count() == 0) SPOOL_TRY(writer.write_meta(dump.meta[0]));
  SPOOL_TRY(write_blocks(writer, dump));
  return writer.finish();
}

// After the fault is gone, the job can be brought to its end.
void expect_recoverable(const std::filesystem::path& path, const Bytes& expected) {
  const std::filesystem::path partial = path.string() + ".partial";
  if (!std::filesystem::exists(path)) {
    auto finished = std::filesystem::exists(partial) ? resume_dump(path, small_dump())
                                                     : make_dump(path, small_dump());
    if (!finished) {  // cut before geometry and channels: nothing to go on with
      ASSERT_EQ(finished.error().code, ErrorCode::kDamage) << finished.error().message;
      ASSERT_LT(std::filesystem::file_size(partial), record_offsets(expected)[2]);
      MadeDump forced = small_dump();
      forced.options.force = true;
      finished = make_dump(path, forced);
    }
    ASSERT_TRUE(finished) << finished.error().message;
  }
  ASSERT_EQ(read_bytes(path), expected);
}

void expect_one_line(const Error& error) {
  EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
  EXPECT_NE(error.message.find(": "), std::string::npos) << error.message;
}

// X1: the k-th call of each kind fails, once and for ever.
TEST(FileFaults, WriterFailsCleanlyAtEveryCall) {
  const Bytes expected = true_bytes();
  size_t runs = 0;
  for (int kind = 0; kind < kCallKinds; ++kind) {
    for (const bool for_ever : {false, true}) {
      for (uint64_t k = 1;; ++k) {
        const ScratchFolder folder;
        const auto path = folder / "a.spool";
        bool struck = false;
        {
          const FaultyCalls faults(
              {.call = static_cast<Call>(kind), .fail_at = k, .for_ever = for_ever});
          const auto made = make_dump(path, small_dump());
          struck = faults.struck();
          if (!made) {
            EXPECT_EQ(made.error().code, ErrorCode::kIo) << made.error().message;
            expect_one_line(made.error());
          }
          // Only close() may fail in silence: everything was synced before; and locks, which some
          // file systems lack.
          const auto call = static_cast<Call>(kind);
          const bool harmless = call == Call::kClose || call == Call::kLock;
          EXPECT_EQ(made.has_value(), !struck || harmless) << kind << " " << k;
        }
        ++runs;
        if (std::filesystem::exists(path)) {
          EXPECT_TRUE(check_dump(path)->complete);
        }
        expect_recoverable(path, expected);
        if (!struck) break;
      }
    }
  }
  EXPECT_GT(runs, 40u);
}

TEST(FileFaults, ReaderFailsCleanlyAtEveryCall) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  ASSERT_TRUE(make_dump(path, small_dump()));
  for (int kind = 0; kind < kCallKinds; ++kind) {
    for (uint64_t k = 1;; ++k) {
      const FaultyCalls faults({.call = static_cast<Call>(kind), .fail_at = k, .for_ever = true});
      const auto job = [&]() -> Result<void> {
        SPOOL_ASSIGN(const SpoolReader reader, SpoolReader::open(path));
        SPOOL_TRY(reader.read_region("radiance", {0, 0, 9, 3}, 0, 3));
        SPOOL_TRY(reader.read_pass_layer("film"));
        SPOOL_TRY(reader.map_block(0, 0, 0));
        return {};
      };
      const auto done = job();
      const bool struck = faults.struck();
      if (!done) {
        EXPECT_EQ(done.error().code, ErrorCode::kIo) << done.error().message;
        expect_one_line(done.error());
      }
      const auto report = check_dump(path);
      if (report && !report->intact()) {
        EXPECT_EQ(static_cast<Call>(kind), Call::kRead);
      }
      const bool harmless = static_cast<Call>(kind) == Call::kClose;
      EXPECT_EQ(done.has_value(), !struck || harmless) << kind << " " << k;
      if (!faults.struck() || k > 200) break;
    }
  }
}

TEST(FileFaults, RecoveryFailsCleanlyAtEveryCall) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  const auto out = folder / "b.spool";
  ASSERT_TRUE(make_dump(path, small_dump()));
  const Bytes expected = read_bytes(path);
  write_bytes(out, Bytes(10, std::byte{3}));
  for (int kind = 0; kind < kCallKinds; ++kind) {
    for (uint64_t k = 1; k < 400; ++k) {
      write_bytes(out, Bytes(10, std::byte{3}));
      const FaultyCalls faults({.call = static_cast<Call>(kind), .fail_at = k});
      const auto done = recover_dump(path, out, true);
      if (!done) expect_one_line(done.error());
      // The old file until the new one is whole. A block that could not be read is a block lost.
      const Bytes now = read_bytes(out);
      if (now != expected && now != Bytes(10, std::byte{3})) {
        EXPECT_EQ(static_cast<Call>(kind), Call::kRead);
        EXPECT_TRUE(done && done->anything_lost()) << k;
      }
      if (!faults.struck()) break;
      std::filesystem::remove(folder / "b.spool.partial");
    }
  }
  EXPECT_EQ(read_bytes(path), expected);
}

// X2
TEST(FileFaults, ShortTransfersAndInterruptionsChangeNothing) {
  const Bytes expected = true_bytes();
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  MadeDump dump = small_dump();
  dump.options.force = true;
  for (uint64_t seed = 0; seed < test::trust_count(2000, 10000); ++seed) {
    const FaultyCalls faults({.random = true, .seed = seed});
    const auto made = make_dump(path, dump);
    ASSERT_TRUE(made) << made.error().message;
    ASSERT_EQ(read_bytes(path), expected);
    const auto report = check_dump(path);
    ASSERT_TRUE(report && report->complete) << seed;
  }
}

TEST(FileFaults, EndlessInterruptionsAndEagainAreErrors) {
  for (const int error : {EINTR, EAGAIN}) {
    const ScratchFolder folder;
    const FaultyCalls faults(
        {.call = Call::kWrite, .fail_at = 2, .for_ever = true, .error = error});
    const auto made = make_dump(folder / "a.spool", small_dump());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kIo);
  }
}

TEST(FileFaults, FailedSyncIsFinal) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  auto writer = SpoolWriter::create(path, small_dump().header, small_dump().options);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(write_blocks(*writer, small_dump()));
  {
    const FaultyCalls faults({.call = Call::kSync, .fail_at = 1});
    const auto finished = writer->finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().code, ErrorCode::kIo);
    // A second fsync would succeed here, and must not be tried.
    EXPECT_FALSE(writer->finish());
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(std::filesystem::exists(folder / "a.spool.partial"));
}

// X3
TEST(FileFaults, DiskFullAtEveryByteIsResumable) {
  const Bytes expected = true_bytes();
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  for (uint64_t limit = 0; limit < expected.size(); ++limit) {
    std::filesystem::remove(path);
    {
      const FaultyCalls faults({.disk_bytes = limit});
      const auto made = make_dump(path, small_dump());
      ASSERT_FALSE(made) << limit;
      ASSERT_EQ(made.error().code, ErrorCode::kIo);
      ASSERT_NE(made.error().message.find("free some space"), std::string::npos);
    }
    ASSERT_FALSE(std::filesystem::exists(path));
    // The torn record is gone.
    const auto partial = folder / "a.spool.partial";
    if (std::filesystem::exists(partial)) {
      ASSERT_LE(std::filesystem::file_size(partial), limit);
    }
    expect_recoverable(path, expected);
  }
}

TEST(FileFaults, RealFileSizeLimitIsResumable) {
  const Bytes expected = true_bytes();
  for (uint64_t limit = 1; limit < expected.size(); limit += test::whole_trust_run() ? 1 : 97) {
    const ScratchFolder folder;
    const auto path = folder / "a.spool";
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(SIGXFSZ, SIG_IGN);
      const struct rlimit size = {limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &size);
      const auto made = make_dump(path, small_dump());
      ::_exit(!made && made.error().code == ErrorCode::kIo ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << limit;
    expect_recoverable(path, expected);
  }
}

// X4: an acknowledged block survives the writer.
TEST(FileFaults, KilledWriterLosesAtMostTheUnfinishedRecord) {
  const MadeDump dump = [] {
    MadeDump large;
    large.header = small_header(32, 32, 64, 1);
    return large;
  }();
  const DumpGeometry geometry(dump.header);
  size_t torn = 0;
  for (uint64_t round = 0; round < test::trust_count(100, 1000); ++round) {
    const ScratchFolder folder;
    const auto path = folder / "a.spool";
    std::array<int, 2> pipe_ends{};
    ASSERT_EQ(::pipe(pipe_ends.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(pipe_ends[0]);
      auto writer = SpoolWriter::create(path, dump.header, dump.options);
      for (uint32_t block = 0; writer && block < geometry.blocks(); ++block) {
        for (uint32_t tile = 0; tile < geometry.groups()[0].tiles; ++tile) {
          const Bytes bytes = block_bytes(geometry, 0, tile, block, dump.seed, false);
          if (!writer->write_block(0, tile, block, 1, bytes)) ::_exit(1);
          const char acknowledged = 1;
          if (::write(pipe_ends[1], &acknowledged, 1) != 1) ::_exit(1);
        }
      }
      ::pause();
    }
    ::close(pipe_ends[1]);
    // Dies somewhere in its first milliseconds, after a number of blocks that differs each time.
    const uint64_t wanted = mix(round) % 600;
    std::array<char, 1024> acks{};
    uint64_t acknowledged = 0;
    while (acknowledged < wanted) {
      const ssize_t got =
          ::read(pipe_ends[0], acks.data(), std::min<uint64_t>(acks.size(), wanted - acknowledged));
      if (got <= 0) break;
      acknowledged += static_cast<uint64_t>(got);
    }
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    for (ssize_t got = 0; (got = ::read(pipe_ends[0], acks.data(), acks.size())) > 0;) {
      acknowledged += static_cast<uint64_t>(got);
    }
    ::close(pipe_ends[0]);
    const auto partial = folder / "a.spool.partial";
    if (!std::filesystem::exists(partial)) {
      ASSERT_EQ(acknowledged, 0u);
      continue;
    }
    torn += std::filesystem::file_size(partial) % kUnit != 0 ? 1 : 0;
    const auto report = recover_dump(partial, folder / "b.spool");
    if (!report) {
      ASSERT_EQ(acknowledged, 0u) << report.error().message;
      continue;
    }
    ASSERT_GE(report->kept_blocks, acknowledged);
    ASSERT_LE(report->kept_blocks, acknowledged + 1);
    const auto reader = SpoolReader::open(folder / "b.spool");
    ASSERT_TRUE(reader);
    for (uint32_t tile = 0; tile < geometry.groups()[0].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.blocks(); ++block) {
        if (!reader->has_block(0, tile, block)) continue;
        ASSERT_EQ(*reader->read_block(0, tile, block),
                  block_bytes(geometry, 0, tile, block, dump.seed, false));
      }
    }
  }
  RecordProperty("torn_tails", static_cast<int>(torn));
}

// X6
TEST(FileFaults, FilesThatChangeUnderAReaderAreErrors) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  {
    auto writer = SpoolWriter::create(path, small_dump().header, small_dump().options);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(write_blocks(*writer, small_dump()));
    EXPECT_EQ(SpoolReader::open(folder / "a.spool.partial").error().code, ErrorCode::kDamage);
    ASSERT_TRUE(writer->finish());
  }
  const auto reader = SpoolReader::open(path);
  ASSERT_TRUE(reader);
  const Bytes before = *reader->read_block(0, 0, 0);
  // Replaced by another dump: the reader keeps the file it opened.
  MadeDump other = small_dump();
  other.options.force = true;
  other.seed = 5;
  ASSERT_TRUE(make_dump(path, other));
  EXPECT_EQ(*reader->read_block(0, 0, 0), before);
  // Cut short under it.
  const auto second = SpoolReader::open(path);
  ASSERT_TRUE(second);
  ASSERT_EQ(::truncate(path.c_str(), 200), 0);
  EXPECT_EQ(second->read_block(0, 0, 0).error().code, ErrorCode::kDamage);
  // Overwritten under it.
  ASSERT_TRUE(make_dump(path, other));
  const auto third = SpoolReader::open(path);
  ASSERT_TRUE(third);
  const Bytes good = read_bytes(path);
  Bytes bad = good;
  bad[record_offsets(good)[2] + 2 * kUnit] ^= std::byte{1};
  for (size_t at : record_offsets(good)) {
    if (at + kUnit < bad.size()) bad[at + kUnit] ^= std::byte{1};
  }
  write_bytes(path, bad);
  EXPECT_EQ(third->read_block(0, 0, 0).error().code, ErrorCode::kDamage);
  EXPECT_EQ(third->map_block(0, 0, 0).error().code, ErrorCode::kDamage);
}

// X7: what the system says is named.
TEST(FileFaults, RefusalsOfTheSystemAreNamed) {
  const std::vector<std::pair<int, std::string>> refusals = {{EACCES, "check the permissions"},
                                                             {EROFS, "check the permissions"},
                                                             {ENOSPC, "free some space"},
                                                             {EMFILE, "close other files"},
                                                             {ENAMETOOLONG, "shorter name"}};
  for (const auto& [error, remedy] : refusals) {
    const ScratchFolder folder;
    const FaultyCalls faults({.call = Call::kOpen, .fail_at = 1, .error = error});
    const auto made = make_dump(folder / "a.spool", small_dump());
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kIo);
    EXPECT_NE(made.error().message.find(remedy), std::string::npos) << made.error().message;
    EXPECT_NE(made.error().message.find("a.spool"), std::string::npos);
  }
  const ScratchFolder folder;
  const FaultyCalls faults({.call = Call::kRename, .fail_at = 1, .error = ENOSPC});
  const auto made = make_dump(folder / "a.spool", small_dump());
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kIo);
  // All of it is there, but the name says that nobody vouched for it.
  EXPECT_TRUE(check_dump(folder / "a.spool.partial")->complete);
  const auto opened = SpoolReader::open(folder / "a.spool.partial");
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDamage);
  EXPECT_NE(opened.error().message.find("spool recover"), std::string::npos);
  ASSERT_TRUE(recover_dump(folder / "a.spool.partial", folder / "b.spool"));
  EXPECT_TRUE(SpoolReader::open(folder / "b.spool"));
}

}  // namespace
}  // namespace spool::format
