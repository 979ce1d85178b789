// Files whose checksums are all right and whose fields lie: the named error, no crash, no memory.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include <gtest/gtest.h>

#include "formats/byte_io.h"
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/structures.h"
#include "tests/formats/crc_repair.h"
#include "tests/formats/made_dump.h"

namespace spool::format {
namespace {

struct Field {
  const char* name;
  size_t offset;
  size_t bytes;
};

enum class Place { kFileHeader, kRecordHeader, kImag, kChan, kIndexEntry, kIndexHeader, kFooter };

// One lie of one field.
struct Lie {
  Place place;
  Field field;
  uint64_t value;
  bool ancillary = false;  // the record that lies is `meta`
};

Bytes with_lie(const Bytes& file, const std::vector<size_t>& offsets, size_t at, const Lie& lie) {
  Bytes lying = file;
  std::memcpy(lying.data() + at + lie.field.offset, &lie.value, lie.field.bytes);
  seal_all(lying, offsets, lie.place == Place::kIndexEntry);
  if (lie.place == Place::kRecordHeader || lie.place == Place::kIndexHeader) {
    // seal_all made the payload CRC right again: a lie about that field must survive.
    std::memcpy(lying.data() + at + lie.field.offset, &lie.value, lie.field.bytes);
    seal_unit(lying, at);
    if (lie.place == Place::kRecordHeader) {
      copy_headers_to_index(lying, offsets, offsets.back());
      seal_payload(lying, offsets.back());
      seal_unit(lying, offsets.back());
    }
  }
  return lying;
}

std::vector<uint64_t> eight_values(const Bytes& file, size_t at, const Field& field) {
  uint64_t now = 0;
  std::memcpy(&now, file.data() + at + field.offset, field.bytes);
  const uint64_t max = field.bytes == 8 ? UINT64_MAX : (uint64_t{1} << (8 * field.bytes)) - 1;
  return {0, 1, max, max / 2 + 1, (now + 1) & max, (now - 1) & max, (now + 64) & max, 77};
}

const std::vector<Field> kFileHeaderFields = {{"major", 8, 2},     {"minor", 10, 2},
                                              {"features", 12, 4}, {"uuid", 16, 8},
                                              {"reserved", 32, 8}, {"reserved end", 56, 4}};
const std::vector<Field> kRecordFields = {
    {"type", 4, 4},   {"sequence", 8, 8}, {"dump_id", 16, 8},      {"stored", 24, 8},
    {"raw", 32, 8},   {"crc", 40, 4},     {"codec", 44, 1},        {"filter", 45, 1},
    {"group", 46, 2}, {"tile", 48, 4},    {"sample_begin", 52, 4}, {"sample_count", 56, 4}};
const std::vector<Field> kImagFields = {
    {"width", 0, 4},          {"height", 4, 4},     {"tile_size", 8, 4},
    {"spp", 12, 4},           {"block_spp", 16, 4}, {"group_count", 20, 4},
    {"channel_count", 24, 4}, {"filter", 28, 4},    {"colour", 32, 4},
    {"sample_order", 36, 4},  {"reserved", 40, 8},  {"reserved end", 60, 4}};
const std::vector<Field> kChanFields = {
    {"name", 0, 8},      {"name end", 31, 1}, {"group", 32, 2},    {"dtype", 34, 2},
    {"semantic", 36, 2}, {"scope", 38, 2},    {"reserved", 40, 8}, {"reserved end", 56, 8}};
const std::vector<Field> kEntryFields = {
    {"offset", 0, 8},       {"type", 8, 4},   {"sequence", 12, 8}, {"dump_id", 20, 8},
    {"stored", 28, 8},      {"raw", 36, 8},   {"crc", 44, 4},      {"codec", 48, 1},
    {"filter", 49, 1},      {"group", 50, 2}, {"tile", 52, 4},     {"sample_begin", 56, 4},
    {"sample_count", 60, 4}};
const std::vector<Field> kFooterFields = {
    {"index_offset", 0, 8},  {"file_bytes", 8, 8}, {"record_count", 16, 8}, {"dump_id", 24, 8},
    {"data_records", 32, 8}, {"flags", 40, 4},     {"reserved", 44, 8},     {"end_magic", 52, 8}};

// Values that the page allows: the file is then another valid file.
bool is_legal(const Lie& lie) {
  const std::string_view name = lie.field.name;
  switch (lie.place) {
    case Place::kFileHeader:
      return name == "minor";  // every minor is read
    case Place::kImag:
      return (name == "sample_order" && lie.value <= 1) || (name == "tile_size" && lie.value == 16);
    case Place::kChan:
      // Another name that keeps to the rules: what a layer is called is free.
      return (name == "semantic" && lie.value <= 9) || (name == "name" && lie.value > 0xFFFF) ||
             (name == "dtype" && lie.value >= 2 && lie.value <= 3);
    case Place::kRecordHeader:
      // meta becomes another ancillary type of four letters, which is skipped.
      return name == "type" && lie.ancillary && lie.value > 0xFFFF && lie.value < 0x7FFFFFFF;
    default:
      return false;
  }
}

// Which exit code a lie must give.
bool is_right_code(const Lie& lie, ErrorCode code) {
  const std::string_view name = lie.field.name;
  const bool damage = code == ErrorCode::kDamage;
  switch (lie.place) {
    case Place::kFileHeader:
      return name == "uuid" ? damage : code == ErrorCode::kData;
    case Place::kImag:
    case Place::kChan:
      // A possible geometry that the blocks contradict is damage of the blocks.
      return damage || code == ErrorCode::kData;
    case Place::kRecordHeader:
      return damage ||
             (code == ErrorCode::kData && (name == "codec" || name == "filter" || name == "type"));
    default:
      return damage;
  }
}

class Lies : public ::testing::TestWithParam<bool> {};

TEST_P(Lies, OfEachFieldGiveTheNamedError) {
  const ScratchFolder folder;
  const MadeDump dump = rich_dump(GetParam());
  ASSERT_TRUE(make_dump(folder / "true.spool", dump));
  const Bytes file = read_bytes(folder / "true.spool");
  const auto offsets = record_offsets(file);
  const auto path = folder / "lie.spool";
  size_t tried = 0;
  const auto try_fields = [&](Place place, size_t at, const std::vector<Field>& fields) {
    for (const Field& field : fields) {
      for (uint64_t value : eight_values(file, at, field)) {
        const bool ancillary =
            load<std::array<char, 4>>(file, at + record_header::kType) == record_type(kTypeMeta);
        const Lie lie = {place, field, value, ancillary};
        Bytes lying = with_lie(file, offsets, at, lie);
        if (lying == file) continue;
        ++tried;
        write_bytes(path, lying);
        const auto reader = SpoolReader::open(path);
        const auto report = check_dump(path);
        const std::string label =
            std::string(field.name) + " = " + std::to_string(value) + " at " + std::to_string(at);
        if (reader) {
          // Only decoding can contradict these: the stored bytes are no frame, or not shuffled.
          const bool late = place == Place::kRecordHeader &&
                            std::string_view(field.name) == "filter" && value <= 1;
          EXPECT_TRUE(is_legal(lie) || late || (report && !report->intact())) << label;
          continue;
        }
        EXPECT_FALSE(is_legal(lie) && std::string_view(field.name) != "name" &&
                     std::string_view(field.name) != "dtype" &&
                     std::string_view(field.name) != "type")
            << label << ": " << reader.error().message;
        EXPECT_TRUE(is_right_code(lie, reader.error().code))
            << label << ": " << reader.error().message;
        EXPECT_EQ(reader.error().message.find('\n'), std::string::npos);
        EXPECT_EQ(report.has_value(), reader.error().code == ErrorCode::kDamage) << label;
        if (report) {
          EXPECT_FALSE(report->intact()) << label;
        }
      }
    }
  };
  try_fields(Place::kFileHeader, 0, kFileHeaderFields);
  for (size_t i = 0; i + 1 < offsets.size(); ++i) {
    try_fields(Place::kRecordHeader, offsets[i], kRecordFields);
    try_fields(Place::kIndexEntry, offsets.back() + kUnit + i * kUnit, kEntryFields);
  }
  try_fields(Place::kIndexHeader, offsets.back(), kRecordFields);
  try_fields(Place::kImag, offsets[0] + kUnit, kImagFields);
  for (size_t c = 0; c < dump.header.channels.size(); ++c) {
    try_fields(Place::kChan, offsets[1] + kUnit + c * kUnit, kChanFields);
  }
  try_fields(Place::kFooter, file.size() - kUnit, kFooterFields);
  EXPECT_GT(tried, 2000u);
}

INSTANTIATE_TEST_SUITE_P(RawAndZstd, Lies, ::testing::Bool());

TEST(LaterMinor, IsReadWithItsUnknownParts) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(false)));
  Bytes file = read_bytes(folder / "a.spool");
  const auto offsets = record_offsets(file);
  const auto path = folder / "later.spool";
  file[file_header::kMinor] = std::byte{1};
  file[file_header::kReserved + 3] = std::byte{9};  // a later meaning
  file[offsets[0] + kUnit + imag::kReserved] = std::byte{9};
  file[offsets[1] + kUnit + chan::kReserved] = std::byte{9};
  file[offsets[1] + kUnit + chan::kSemantic] = std::byte{99};
  file[file.size() - kUnit + footer::kReserved] = std::byte{9};
  file[file.size() - kUnit + footer::kFlags] |= std::byte{2};
  std::memcpy(file.data() + offsets[2] + record_header::kType, "metb", 4);  // was meta
  seal_all(file, offsets);
  write_bytes(path, file);
  const auto reader = SpoolReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE(reader->meta().empty());
  EXPECT_EQ(reader->header().channels[0].semantic, 0);
  EXPECT_TRUE(check_dump(path)->intact());
  // The same with minor 0 breaks the rules of this page.
  file[file_header::kMinor] = std::byte{0};
  seal_all(file, offsets);
  write_bytes(path, file);
  EXPECT_EQ(SpoolReader::open(path).error().code, ErrorCode::kData);
}

TEST(UnknownCriticalRecord, IsUnsupported) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(false)));
  Bytes file = read_bytes(folder / "a.spool");
  const auto offsets = record_offsets(file);
  std::memcpy(file.data() + offsets[2] + record_header::kType, "META", 4);
  seal_all(file, offsets);
  write_bytes(folder / "a.spool", file);
  const auto reader = SpoolReader::open(folder / "a.spool");
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::kData);
  EXPECT_NE(reader.error().message.find("META"), std::string::npos);
}

#if defined(__SANITIZE_ADDRESS__)
constexpr double kMostMebibytes = 512;  // half of it is freed memory that the sanitizer holds back
#elif defined(__SANITIZE_THREAD__)
constexpr double kMostMebibytes = 4 * 256;  // every word has a shadow of two to four
#else
constexpr double kMostMebibytes = 256;
#endif

// Runs `job` in a process of its own; its peak memory in MiB above the start, and seconds.
struct Cost {
  double mebibytes = 0;
  double seconds = 0;
  bool done = false;
};
template <class Job>
Cost cost_of(Job job) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) ::_exit(job() ? 0 : 1);
  int status = 0;
  struct rusage usage{};
  ::wait4(child, &status, 0, &usage);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {static_cast<double>(usage.ru_maxrss) / 1024, seconds.count(),
          WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

TEST(MemoryBombs, AreRefusedCheaply) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(false)));
  const Bytes file = read_bytes(folder / "a.spool");
  const auto offsets = record_offsets(file);
  const size_t image = offsets[0] + kUnit;
  struct Bomb {
    size_t at;
    std::vector<uint32_t> words;
  };
  const std::vector<Bomb> bombs = {
      {image + imag::kWidth, {65536, 65536}},
      {image + imag::kWidth, {16384, 16384, 8, 65536, 1}},
      {image + imag::kWidth, {65536, 4096, 256, 65536, 1024}},
      {image + imag::kSpp, {65536, 1024}},
      {file.size() - kUnit + footer::kRecordCount, {1u << 20, 0}},
      {file.size() - kUnit + footer::kIndexOffset, {0xFFFFFFC0u, 0xFFFFFFFFu}},
      {offsets.back() + record_header::kStoredBytes, {1u << 26, 0, 1u << 26, 0}},
      {offsets[3] + record_header::kStoredBytes, {1u << 26, 0, 1u << 26, 0}},
  };
  const auto path = folder / "bomb.spool";
  for (const Bomb& bomb : bombs) {
    Bytes bytes = file;
    std::memcpy(bytes.data() + bomb.at, bomb.words.data(), bomb.words.size() * 4);
    seal_all(bytes, offsets);
    write_bytes(path, bytes);
    const Cost cost = cost_of([&] {
      const bool refused = !SpoolReader::open(path).has_value();
      const auto report = check_dump(path);
      return refused && (!report || !report->intact());
    });
    EXPECT_TRUE(cost.done) << bomb.at;
    EXPECT_LT(cost.mebibytes, kMostMebibytes) << bomb.at;
    EXPECT_LT(cost.seconds, 1) << bomb.at;
  }
}

TEST(MemoryBombs, CompressedZerosCostOneBlockAtATime) {
  const ScratchFolder folder;
  const auto path = folder / "zeros.spool";
  // 64 MiB blocks, as large as the page allows, that take a few KiB in the file.
  DumpHeader header = small_header(512, 512, 85, 85, 256);
  const DumpGeometry geometry(header);
  {
    auto writer = SpoolWriter::create(path, header, {.compress = true});
    ASSERT_TRUE(writer);
    const Bytes zeros(geometry.raw_bytes(0, 0, 0));
    ASSERT_GT(zeros.size(), size_t{63} << 20);
    for (uint32_t tile = 0; tile < 4; ++tile) {
      ASSERT_TRUE(writer->write_block(0, tile, 0, 85, zeros));
    }
    ASSERT_TRUE(writer->finish());
  }
  EXPECT_LT(std::filesystem::file_size(path), 200000u);
  const Cost cost = cost_of([&] { return check_dump(path)->intact(); });
  EXPECT_TRUE(cost.done);
  EXPECT_LT(cost.mebibytes, kMostMebibytes);
}

// Many intact headers whose payloads overlap and all fail: checking must not take quadratic time.
TEST(OverlappingRecords, AreScannedInBoundedTime) {
  const ScratchFolder folder;
  ASSERT_TRUE(make_dump(folder / "a.spool", rich_dump(false)));
  Bytes file = read_bytes(folder / "a.spool");
  const size_t data = record_offsets(file)[3];
  const Bytes head(file.begin() + static_cast<ptrdiff_t>(data),
                   file.begin() + static_cast<ptrdiff_t>(data + kUnit));
  file.resize(data);
  const size_t count = (size_t{8} << 20) / kUnit;
  for (size_t i = 0; i < count; ++i) {
    Bytes lie = head;
    const uint64_t claim = (count - i - 1) * kUnit;
    if (claim == 0) break;
    store(std::span(lie), record_header::kStoredBytes, claim);
    store(std::span(lie), record_header::kRawBytes, claim);
    seal_unit(lie, 0);
    file.insert(file.end(), lie.begin(), lie.end());
  }
  write_bytes(folder / "a.spool", file);
  const Cost cost = cost_of([&] {
    const auto report = check_dump(folder / "a.spool");
    return report && !report->intact();
  });
  EXPECT_TRUE(cost.done);
  EXPECT_LT(cost.seconds, 5);
}

}  // namespace
}  // namespace spool::format
