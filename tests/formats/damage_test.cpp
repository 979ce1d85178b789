// Damage is found: each bit, each cut, each exchange of parts. [spool.md 7]
#include <fcntl.h>
#include <unistd.h>

#include <cstring>

#include <gtest/gtest.h>

#include "formats/byte_io.h"
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "tests/formats/crc_repair.h"
#include "tests/formats/made_dump.h"
#include "tests/support/trust.h"

namespace spool::format {
namespace {

Bytes made_bytes(const ScratchFolder& folder, MadeDump dump) {
  dump.options.force = true;
  const auto made = make_dump(folder / "made.spool", dump);
  EXPECT_TRUE(made) << made.error().message;
  return read_bytes(folder / "made.spool");
}

// True when open() reads the byte: a header, the index or the footer.
std::vector<bool> structural_bytes(const Bytes& file) {
  std::vector<bool> structural(file.size());
  const auto mark = [&](size_t at, size_t count) {
    for (size_t i = at; i < at + count; ++i)
      structural[i] = true;
  };
  mark(0, kUnit);
  const auto offsets = record_offsets(file);
  for (size_t at : offsets)
    mark(at, kUnit);
  mark(offsets.back(), file.size() - offsets.back());
  return structural;
}

// Whether a file on disk opens, and whether checking it finds it intact.
struct Verdict {
  bool opens = false;
  bool intact = false;
};
Verdict judge(const std::filesystem::path& path) {
  Verdict verdict;
  const auto report = check_dump(path);
  EXPECT_TRUE(report) << report.error().message;
  if (report) {
    verdict = {report->opens, report->intact()};
    EXPECT_EQ(report->damaged.empty(), verdict.intact);
    EXPECT_EQ(report->open_error.empty(), verdict.opens);
  }
  return verdict;
}

class EveryBit : public ::testing::TestWithParam<bool> {};

TEST_P(EveryBit, FlippedAnywhereIsFound) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(GetParam());
  const Bytes file = made_bytes(folder, dump);
  ASSERT_LE(file.size(), 16384u);
  const auto path = folder / "made.spool";
  ASSERT_TRUE(judge(path).intact);
  if (GetParam()) {
    ASSERT_FALSE(SpoolReader::open(path)->is_raw(0, 0, 0));
  }
  const std::vector<bool> structural = structural_bytes(file);
  const int fd = ::open(path.c_str(), O_RDWR);
  ASSERT_GE(fd, 0);
  size_t missed = 0;
  for (size_t at = 0; at < file.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      const auto flipped = file[at] ^ static_cast<std::byte>(1 << bit);
      ASSERT_EQ(::pwrite(fd, &flipped, 1, static_cast<off_t>(at)), 1);
      const Verdict verdict = judge(path);
      if (verdict.intact || (structural[at] && verdict.opens)) {
        ++missed;
        ADD_FAILURE() << "bit " << bit << " of byte " << at;
      }
    }
    ASSERT_EQ(::pwrite(fd, &file[at], 1, static_cast<off_t>(at)), 1);
  }
  ::close(fd);
  EXPECT_EQ(missed, 0u) << "of " << file.size() * 8;
}

INSTANTIATE_TEST_SUITE_P(RawAndZstd, EveryBit, ::testing::Bool());

TEST(TwoBits, FlippedInOneHeaderAreFound) {
  const ScratchFolder folder;
  const Bytes file = made_bytes(folder, rich_dump(false));
  const size_t data_header = record_offsets(file)[3];
  // CRC-32 has Hamming distance above 2 at this length: all 130 816 pairs, without a file each.
  for (size_t at : {size_t{0}, data_header, file.size() - kUnit}) {
    size_t missed = 0;
    for (size_t a = 0; a < 512; ++a) {
      for (size_t b = a + 1; b < 512; ++b) {
        std::array<std::byte, kUnit> unit{};
        std::memcpy(unit.data(), file.data() + at, kUnit);
        unit[a / 8] ^= static_cast<std::byte>(1 << (a % 8));
        unit[b / 8] ^= static_cast<std::byte>(1 << (b % 8));
        if (crc32(std::span(unit).first(60)) == load<uint32_t>(unit, 60)) ++missed;
      }
    }
    EXPECT_EQ(missed, 0u);
  }
}

// F4: two to eight bits anywhere in a file.
TEST(ManyBits, FlippedAnywhereAreFound) {
  const ScratchFolder folder;
  const auto path = folder / "a.spool";
  ASSERT_TRUE(make_dump(path, rich_dump(true)));
  const Bytes good = read_bytes(path);
  const uint64_t count = test::trust_count(20000, 1000000);
  for (uint64_t i = 0; i < count; ++i) {
    Bytes bad = good;
    const uint64_t bits = 2 + mix(i) % 7;
    for (uint64_t k = 0; k < bits; ++k) {
      const uint64_t bit = mix(i * 8 + k) % (good.size() * 8);
      bad[bit / 8] ^= std::byte{1} << (bit % 8);
    }
    if (bad == good) continue;  // a bit was drawn twice
    write_bytes(path, bad);
    const auto report = check_dump(path);
    ASSERT_FALSE(report && report->intact()) << i;
  }
}

TEST(Truncation, AtEveryByteNeverOpensAndKeepsWholeRecords) {
  const ScratchFolder folder;
  for (const bool compressed : {false, true}) {
    const Bytes file = made_bytes(folder, rich_dump(compressed));
    const auto path = folder / "made.spool";
    std::vector<size_t> offsets = record_offsets(file);
    offsets.push_back(file.size() - kUnit);
    for (size_t size = file.size(); size-- > 0;) {
      ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(size)), 0);
      const auto reader = SpoolReader::open(path);
      ASSERT_FALSE(reader) << size;
      ASSERT_EQ(reader.error().code, ErrorCode::kDamage) << reader.error().message;
      ASSERT_NE(reader.error().message.find("spool recover"), std::string::npos);
      size_t whole = 0;
      while (whole + 1 < offsets.size() && offsets[whole + 1] <= size)
        ++whole;
      const auto report = check_dump(path);
      ASSERT_TRUE(report) << report.error().message;
      ASSERT_EQ(report->records, whole) << size;
      ASSERT_FALSE(report->intact());
    }
  }
}

TEST(Extension, ByAnyBytesIsDamage) {
  const ScratchFolder folder;
  const Bytes file = made_bytes(folder, rich_dump(false));
  const auto path = folder / "longer.spool";
  for (const std::byte fill : {std::byte{0}, std::byte{0x53}}) {
    for (size_t extra = 1; extra <= 4096;
         extra += extra < 130 || test::whole_trust_run() ? 1 : 61) {
      Bytes longer = file;
      longer.resize(file.size() + extra, fill);
      write_bytes(path, longer);
      EXPECT_FALSE(judge(path).opens) << extra;
    }
  }
  // A footer repeated, and two files in a row.
  Bytes twice = file;
  twice.insert(twice.end(), file.end() - kUnit, file.end());
  write_bytes(path, twice);
  EXPECT_FALSE(judge(path).opens);
  twice = file;
  twice.insert(twice.end(), file.begin(), file.end());
  write_bytes(path, twice);
  EXPECT_FALSE(judge(path).opens);
}

TEST(FileInsideAFile, IsNotMistakenForRecords) {
  const ScratchFolder folder;
  const Bytes inner = made_bytes(folder, rich_dump(false));
  // A block that happens to hold a whole .spool file of another dump, at a multiple of 64.
  MadeDump outer;
  outer.header = small_header(16, 16, 8, 8, 16);
  outer.options.uuid->fill(0x77);
  Bytes payload(3 * 16 * 16 * 8 * 4);
  ASSERT_LE(inner.size(), payload.size());
  std::memcpy(payload.data(), inner.data(), inner.size());
  const auto path = folder / "outer.spool";
  auto writer = SpoolWriter::create(path, outer.header, outer.options);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write_block(0, 0, 0, 8, payload));
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(judge(path).intact);
  // With the outer record damaged, the inner records are still foreign.
  Bytes file = read_bytes(path);
  file[record_offsets(file)[2] + kUnit + inner.size() + 5] ^= std::byte{1};
  write_bytes(path, file);
  const auto report = check_dump(path);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->records, 3u);  // IMAG, CHAN, INDX
  ASSERT_EQ(report->missing.size(), 1u);
}

TEST(Substitution, OfPartsBetweenDumpsIsFound) {
  const ScratchFolder folder;
  MadeDump first = rich_dump(false);
  MadeDump second = first;
  second.seed = 2;
  second.options.uuid->fill(0x55);
  MadeDump same_id = second;
  same_id.options.uuid = first.options.uuid;
  const Bytes a = made_bytes(folder, first);
  const auto offsets = record_offsets(a);
  const auto path = folder / "swapped.spool";
  for (const MadeDump& other : {second, same_id}) {
    const Bytes b = made_bytes(folder, other);
    ASSERT_EQ(a.size(), b.size());
    const auto try_copy = [&](size_t at, size_t bytes) {
      Bytes mixed = a;
      std::memcpy(mixed.data() + at, b.data() + at, bytes);
      if (mixed == a) return;  // equal in both dumps: nothing was exchanged
      write_bytes(path, mixed);
      EXPECT_FALSE(judge(path).intact) << at << "+" << bytes;
    };
    try_copy(0, kUnit);
    for (size_t i = 0; i < offsets.size(); ++i) {
      const size_t end = i + 1 < offsets.size() ? offsets[i + 1] : a.size() - kUnit;
      try_copy(offsets[i], kUnit);
      try_copy(offsets[i] + kUnit, end - offsets[i] - kUnit);
      try_copy(offsets[i], end - offsets[i]);
      try_copy(offsets.back() + kUnit + i * kUnit, i + 1 < offsets.size() ? kUnit : 0);
    }
    try_copy(a.size() - kUnit, kUnit);
    try_copy(offsets.back(), a.size() - offsets.back());
  }
}

TEST(Substitution, OfRecordsInsideADumpIsFound) {
  const ScratchFolder folder;
  MadeDump dump;
  dump.header = small_header(16, 16, 4, 2);
  const Bytes file = made_bytes(folder, dump);
  const auto offsets = record_offsets(file);
  const size_t size = offsets[3] - offsets[2];
  const auto path = folder / "swapped.spool";
  for (size_t i = 2; i + 2 < offsets.size(); ++i) {
    for (size_t k = i + 1; k + 1 < offsets.size(); ++k) {
      Bytes whole = file;
      std::swap_ranges(whole.begin() + static_cast<ptrdiff_t>(offsets[i]),
                       whole.begin() + static_cast<ptrdiff_t>(offsets[i] + size),
                       whole.begin() + static_cast<ptrdiff_t>(offsets[k]));
      write_bytes(path, whole);
      EXPECT_FALSE(judge(path).opens);
      // Even when the index was made again to match.
      seal_all(whole, offsets);
      write_bytes(path, whole);
      EXPECT_FALSE(judge(path).opens);
    }
  }
}

TEST(ForeignFiles, AreNamedAsSuch) {
  const ScratchFolder folder;
  const auto path = folder / "foreign.spool";
  const auto code_of = [&](const Bytes& bytes) {
    write_bytes(path, bytes);
    const auto reader = SpoolReader::open(path);
    EXPECT_FALSE(reader);
    return reader ? ErrorCode{} : reader.error().code;
  };
  EXPECT_EQ(code_of({}), ErrorCode::kDamage);
  EXPECT_EQ(code_of(Bytes(3, std::byte{'x'})), ErrorCode::kData);
  EXPECT_EQ(code_of(Bytes(4096, std::byte{0})), ErrorCode::kData);
  Bytes file = made_bytes(folder, rich_dump(false));
  Bytes unix_ends = file;
  unix_ends.erase(unix_ends.begin() + 4);
  EXPECT_EQ(code_of(unix_ends), ErrorCode::kDamage);
  EXPECT_EQ(SpoolReader::open(folder / "missing.spool").error().code, ErrorCode::kIo);
  EXPECT_EQ(SpoolReader::open(folder.path()).error().code, ErrorCode::kIo);
  EXPECT_EQ(check_dump(folder / "missing.spool").error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace spool::format
