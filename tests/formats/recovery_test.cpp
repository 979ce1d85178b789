// Every intact record survives: cuts at each byte, holes at each place, and writing on after a cut.
#include <unistd.h>

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/crc_repair.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

template <class T>
std::string why(const Result<T>& result) {
  return result ? "" : result.error().message;
}

// Starts of all records and of the footer.
std::vector<size_t> boundaries(const Bytes& file) {
  std::vector<size_t> offsets = record_offsets(file);
  offsets.push_back(file.size() - kUnit);
  return offsets;
}

size_t data_records_before(const Bytes& file, const std::vector<size_t>& starts, size_t count) {
  size_t data = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto type = load<std::array<char, 4>>(file, starts[i] + record_header::kType);
    data += std::string_view(type.data(), 4) == kTypeData ? 1 : 0;
  }
  return data;
}

// Every block of `recovered` is bit for bit what `dump` says; returns how many there are.
size_t count_true_blocks(const std::filesystem::path& recovered, const MadeDump& dump) {
  const auto reader = SpoolReader::open(recovered);
  EXPECT_TRUE(reader) << why(reader);
  if (!reader) return 0;
  const DumpGeometry geometry(dump.header);
  size_t count = 0;
  for (uint16_t group = 0; group < geometry.groups().size(); ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        if (!reader->has_block(group, tile, block)) continue;
        ++count;
        EXPECT_EQ(*reader->read_block(group, tile, block),
                  block_bytes(geometry, group, tile, block, dump.seed, dump.smooth));
      }
    }
  }
  return count;
}

class Recovery : public ::testing::TestWithParam<bool> {};

TEST_P(Recovery, OfACutFileKeepsExactlyTheWholeRecords) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(GetParam());
  const auto path = folder / "cut.spool";
  const auto out = folder / "out.spool";
  ASSERT_TRUE(make_dump(path, dump));
  const Bytes file = read_bytes(path);
  const auto starts = boundaries(file);
  for (size_t size = file.size(); size-- > 0;) {
    ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(size)), 0);
    size_t whole = 0;
    while (whole + 1 < starts.size() && starts[whole + 1] <= size)
      ++whole;
    const auto report = recover_dump(path, out, true);
    if (whole < 2) {
      ASSERT_FALSE(report) << size;
      ASSERT_EQ(report.error().code, ErrorCode::kDamage) << report.error().message;
      ASSERT_FALSE(std::filesystem::exists(folder / "out.spool.partial"));
      continue;
    }
    ASSERT_TRUE(report) << why(report);
    const size_t data = data_records_before(file, starts, whole);
    ASSERT_EQ(report->kept_blocks, data) << size;
    if (size % 61 == 0) {
      ASSERT_EQ(count_true_blocks(out, dump), data) << size;
    }
    // Something is lost unless the cut fell behind the last record of data, between two records, or
    // behind the header of the index.
    const size_t index_header_end = starts[starts.size() - 2] + kUnit;
    const bool between = size == starts[whole] || size >= index_header_end;
    const bool all_there = data == DumpGeometry(dump.header).slot_count();
    ASSERT_EQ(report->anything_lost(), !between || !all_there) << size;
    ASSERT_EQ(report->lost.size() + report->absent.size(),
              DumpGeometry(dump.header).slot_count() - data);
  }
}

TEST_P(Recovery, OfAFileWithAHoleLosesOnlyWhatTheHoleTouches) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(GetParam());
  const auto path = folder / "hole.spool";
  const auto out = folder / "out.spool";
  ASSERT_TRUE(make_dump(path, dump));
  const Bytes file = read_bytes(path);
  const auto starts = boundaries(file);
  for (const size_t length : {size_t{1}, size_t{64}, size_t{300}}) {
    for (size_t at = 0; at + length <= file.size(); at += 37) {
      Bytes holed = file;
      for (size_t i = at; i < at + length; ++i)
        holed[i] = ~holed[i];
      write_bytes(path, holed);
      std::vector<size_t> touched;
      for (size_t i = 0; i + 1 < starts.size(); ++i) {
        if (at < starts[i + 1] && at + length > starts[i]) touched.push_back(i);
      }
      const auto report = recover_dump(path, out, true);
      if (!touched.empty() && touched.front() < 2) {
        ASSERT_FALSE(report) << at;
        continue;
      }
      ASSERT_TRUE(report) << why(report);
      size_t lost_data = 0;
      for (size_t i : touched) {
        lost_data +=
            data_records_before(file, starts, i + 1) - data_records_before(file, starts, i);
      }
      const size_t all = data_records_before(file, starts, starts.size() - 1);
      ASSERT_EQ(report->kept_blocks, all - lost_data) << at;
      // The index still names what is gone, unless the hole took it too.
      const bool index_gone = !touched.empty() && touched.back() + 2 == starts.size();
      if (!index_gone) {
        ASSERT_EQ(report->lost.size(), lost_data) << at;
      }
      const bool meta_lost = std::ranges::find(touched, size_t{2}) != touched.end();
      if (lost_data + (meta_lost ? 1 : 0) > 0) {
        ASSERT_TRUE(report->anything_lost()) << at;
      }
      if (at % 5 == 0) {
        ASSERT_EQ(count_true_blocks(out, dump), all - lost_data);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(RawAndZstd, Recovery, ::testing::Bool());

TEST(Recover, OfAnIntactFileChangesNothing) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(true)));
  const auto report = recover_dump(folder / "a.spool", folder / "b.spool");
  ASSERT_TRUE(report) << why(report);
  EXPECT_FALSE(report->anything_lost());
  EXPECT_TRUE(report->damaged.empty());
  EXPECT_EQ(read_bytes(folder / "a.spool"), read_bytes(folder / "b.spool"));
  // Not onto itself, not over another file.
  EXPECT_EQ(recover_dump(folder / "a.spool", folder / "a.spool", true).error().code,
            ErrorCode::kUsage);
  EXPECT_EQ(recover_dump(folder / "a.spool", folder / "b.spool").error().code, ErrorCode::kUsage);
}

TEST(Recover, RepairsADamagedFileHeader) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(false);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  const Bytes file = read_bytes(folder / "a.spool");
  Bytes bad = file;
  bad[20] ^= std::byte{4};
  write_bytes(folder / "a.spool", bad);
  const auto report = recover_dump(folder / "a.spool", folder / "b.spool");
  ASSERT_TRUE(report) << why(report);
  EXPECT_FALSE(report->anything_lost());
  EXPECT_EQ(read_bytes(folder / "b.spool"), file);
}

TEST(Recover, DropsRecordsThatBreakTheRules) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(false);
  ASSERT_TRUE(make_dump(folder / "a.spool", dump));
  Bytes file = read_bytes(folder / "a.spool");
  const auto offsets = record_offsets(file);
  file[offsets[2] + kUnit] = std::byte{'['};                    // meta: no object
  std::memcpy(file.data() + offsets[4] + record_header::kTile,  // a block twice
              file.data() + offsets[3] + record_header::kTile, 12);
  std::memcpy(file.data() + offsets[4] + record_header::kRawBytes,
              file.data() + offsets[3] + record_header::kRawBytes, 8);
  seal_all(file, offsets);
  write_bytes(folder / "a.spool", file);
  const auto report = recover_dump(folder / "a.spool", folder / "b.spool");
  ASSERT_TRUE(report) << why(report);
  EXPECT_TRUE(report->anything_lost());
  EXPECT_EQ(report->kept_blocks, DumpGeometry(dump.header).slot_count() - 1);
  EXPECT_TRUE(SpoolReader::open(folder / "b.spool")->meta().empty());
}

RC_GTEST_PROP(Recover, OfRandomlyDamagedFilesOpensAndTellsTheTruth, ()) {
  static const ScratchFolder folder;
  const auto path = folder / "random.spool";
  const auto out = folder / "out.spool";
  const MadeDump dump = rich_dump(*rc::gen::arbitrary<bool>());
  static const std::array<Bytes, 2> originals = [] {
    std::array<Bytes, 2> files;
    for (size_t i = 0; i < 2; ++i) {
      const auto original = folder / (i == 0 ? "raw.spool" : "zstd.spool");
      if (make_dump(original, rich_dump(i == 1))) files[i] = read_bytes(original);
    }
    return files;
  }();
  Bytes file = originals[dump.smooth ? 1 : 0];
  const auto blows = *rc::gen::inRange(1, 4);
  for (int i = 0; i < blows; ++i) {
    const auto at = *rc::gen::inRange<size_t>(0, file.size());
    const auto length = std::min(*rc::gen::inRange<size_t>(1, 700), file.size() - at);
    const auto first = file.begin() + static_cast<ptrdiff_t>(at);
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        std::fill(first, first + static_cast<ptrdiff_t>(length), std::byte{0});
        break;
      case 1:
        file.erase(first, first + static_cast<ptrdiff_t>(length));
        break;
      default:
        file.insert(first, length, std::byte{0x9E});
    }
    if (file.empty()) break;
  }
  write_bytes(path, file);
  const auto report = recover_dump(path, out, true);
  if (!report) return;  // header, IMAG or CHAN gone: refused with one line
  RC_ASSERT(check_dump(out)->intact());
  RC_ASSERT(count_true_blocks(out, dump) == report->kept_blocks);
}

TEST_P(Recovery, ResumingAfterACutGivesTheSameFile) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(GetParam());
  const auto path = folder / "a.spool";
  const auto partial = folder / "a.spool.partial";
  ASSERT_TRUE(make_dump(path, dump));
  const Bytes file = read_bytes(path);
  const auto starts = boundaries(file);
  for (size_t size = 0; size <= file.size(); ++size) {
    std::filesystem::remove(path);
    write_bytes(partial, Bytes(file.begin(), file.begin() + static_cast<ptrdiff_t>(size)));
    auto writer = SpoolWriter::resume(path, dump.options);
    if (size < starts[2]) {
      ASSERT_FALSE(writer) << size;
      ASSERT_EQ(writer.error().code, ErrorCode::kDamage) << why(writer);
      continue;
    }
    ASSERT_TRUE(writer) << size << why(writer);
    if (writer->meta_count() == 0) {
      ASSERT_TRUE(writer->write_meta(dump.meta[0]));
    }
    ASSERT_TRUE(write_blocks(*writer, dump));
    const auto finished = writer->finish();
    ASSERT_TRUE(finished) << why(finished);
    ASSERT_EQ(read_bytes(path), file) << size;
  }
}

TEST(Resume, RefusesAHoleInTheMiddle) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(false)));
  Bytes file = read_bytes(folder / "a.spool");
  file[record_offsets(file)[4] + 70] ^= std::byte{1};
  write_bytes(folder / "b.spool.partial", file);
  const auto writer = SpoolWriter::resume(folder / "b.spool");
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::kDamage);
  EXPECT_EQ(read_bytes(folder / "b.spool.partial"), file);
  EXPECT_EQ(SpoolWriter::resume(folder / "none.spool").error().code, ErrorCode::kIo);
}

TEST(Resume, RefusesAFileThatIsBeingWritten) {
  const ScratchFolder folder;
  auto first = SpoolWriter::create(folder / "a.spool", small_header(4, 4, 1, 1));
  ASSERT_TRUE(first);
  const auto second = SpoolWriter::resume(folder / "a.spool");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace spool::format
