// Files made by a third writer (tests/golden): each is read as listed, each bad one is refused as
// listed.
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/crc32.h"
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/formats/made_dump.h"
#include "tests/support/source_directory.h"

namespace spool::format {
namespace {

using Json = nlohmann::json;

const std::filesystem::path kGolden = test::source_directory() / "tests/golden";

Json read_json(const std::filesystem::path& path) {
  std::ifstream in(path);
  return Json::parse(in, nullptr, false);
}

std::vector<std::filesystem::path> dumps_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".spool") paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

std::string hex(std::span<const uint8_t> bytes) {
  std::string text;
  for (uint8_t byte : bytes)
    text += fmt::format("{:02x}", byte);
  return text;
}

void expect_header(const DumpHeader& header, const Json& expected) {
  EXPECT_EQ(header.width, expected["width"]);
  EXPECT_EQ(header.height, expected["height"]);
  EXPECT_EQ(header.tile_size, expected["tile_size"]);
  EXPECT_EQ(header.spp, expected["spp"]);
  EXPECT_EQ(header.block_spp, expected["block_spp"]);
  EXPECT_EQ(static_cast<uint32_t>(header.sample_order), expected["sample_order"]);
  EXPECT_EQ(hex(header.uuid), expected["uuid"].get<std::string>());
  ASSERT_EQ(header.channels.size(), expected["channels"].size());
  for (size_t c = 0; c < header.channels.size(); ++c) {
    const ChannelInfo& channel = header.channels[c];
    const Json actual = {channel.name, channel.group, static_cast<uint16_t>(channel.type),
                         channel.semantic, static_cast<uint16_t>(channel.scope)};
    EXPECT_EQ(actual, expected["channels"][c]);
  }
}

void expect_blocks(const SpoolReader& reader, const Json& expected) {
  const DumpGeometry geometry(reader.header());
  for (const Json& block : expected) {
    const uint16_t group = block["group"];
    const uint32_t tile = block["tile"];
    const uint32_t begin = block["sample_begin"];
    const uint32_t number = begin / reader.header().block_spp;
    const auto bytes = reader.read_block(group, tile, number);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ(bytes->size(), block["bytes"]);
    EXPECT_EQ(crc32(*bytes), block["crc32"]);
    EXPECT_EQ(reader.is_raw(group, tile, number), block["codec"] == 0);
  }
  uint32_t present = 0;
  const auto groups = static_cast<uint16_t>(geometry.groups().size());
  for (uint16_t group = 0; group < groups; ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        present += reader.has_block(group, tile, block) ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(present, expected.size());
}

TEST(Golden, EveryFileHoldsWhatIsListed) {
  const auto paths = dumps_in(kGolden / "v1.0");
  EXPECT_GE(paths.size(), 64u);
  for (const auto& path : paths) {
    SCOPED_TRACE(path.filename());
    std::filesystem::path listing = path;
    const Json expected = read_json(listing.replace_extension(".json"));
    ASSERT_FALSE(expected.is_discarded());
    const auto reader = SpoolReader::open(path);
    ASSERT_TRUE(reader) << reader.error().message;
    expect_header(reader->header(), expected);
    EXPECT_EQ(reader->complete(), expected["complete"]);
    EXPECT_EQ(Json(reader->meta()), expected["meta"]);
    expect_blocks(*reader, expected["blocks"]);
    const auto report = check_dump(path);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(report->intact());
    EXPECT_EQ(report->complete, expected["complete"]);
    EXPECT_EQ(report->records, expected["records"]);
  }
}

// What our writer makes of the same blocks in the same order is the same file, where nothing is
// compressed.
TEST(Golden, RawFilesAreWrittenByteForByte) {
  const ScratchFolder folder;
  size_t compared = 0;
  for (const auto& path : dumps_in(kGolden / "v1.0")) {
    SCOPED_TRACE(path.filename());
    std::filesystem::path listing = path;
    const Json expected = read_json(listing.replace_extension(".json"));
    const auto reader = SpoolReader::open(path);
    ASSERT_TRUE(reader);
    bool raw = path.stem() != "unknown_ancillary" && path.stem() != "later_minor";
    for (const Json& block : expected["blocks"])
      raw = raw && block["codec"] == 0;
    if (!raw) continue;
    auto writer = SpoolWriter::create(folder / "a.spool", reader->header(),
                                      {.force = true, .uuid = reader->header().uuid});
    ASSERT_TRUE(writer);
    for (const std::string& text : reader->meta())
      ASSERT_TRUE(writer->write_meta(text));
    for (const Json& block : expected["blocks"]) {
      const uint32_t begin = block["sample_begin"];
      const auto bytes =
          reader->read_block(block["group"], block["tile"], begin / reader->header().block_spp);
      ASSERT_TRUE(
          writer->write_block(block["group"], block["tile"], begin, block["sample_count"], *bytes));
    }
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(read_bytes(folder / "a.spool"), read_bytes(path));
    ++compared;
  }
  EXPECT_GE(compared, 30u);
}

TEST(Golden, EveryBadFileIsRefusedByItsClass) {
  const std::map<std::string, ErrorCode> codes = {{"not_spool", ErrorCode::kData},
                                                  {"unsupported", ErrorCode::kData},
                                                  {"invalid", ErrorCode::kData},
                                                  {"incomplete", ErrorCode::kDamage},
                                                  {"damaged", ErrorCode::kDamage}};
  const std::map<std::string, std::string> remedies = {{"not_spool", "spool pack"},
                                                       {"unsupported", "newer version"},
                                                       {"invalid", "write it again"},
                                                       {"incomplete", "spool recover"},
                                                       {"damaged", "spool recover"}};
  const ScratchFolder folder;
  const Json expected = read_json(kGolden / "must_fail/expected.json");
  const auto paths = dumps_in(kGolden / "must_fail");
  EXPECT_GE(paths.size(), 100u);
  EXPECT_EQ(paths.size(), expected.size());
  for (const auto& path : paths) {
    SCOPED_TRACE(path.filename());
    const Json& listed = expected[path.stem()];
    const std::string failure = listed["class"];
    const auto reader = SpoolReader::open(path);
    EXPECT_EQ(reader.has_value(), listed["opens"]);
    if (!reader) {
      const std::string& line = reader.error().message;
      EXPECT_EQ(reader.error().code, codes.at(failure)) << line;
      EXPECT_NE(line.find(remedies.at(failure)), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_TRUE(line.starts_with(path.string() + ": ")) << line;
    }
    const auto report = check_dump(path);
    EXPECT_EQ(report.has_value(), codes.at(failure) == ErrorCode::kDamage);
    if (report) {
      EXPECT_FALSE(report->intact());
    }
    // Whatever can be saved of it is a sound file.
    if (recover_dump(path, folder / "saved.spool", true)) {
      EXPECT_TRUE(check_dump(folder / "saved.spool")->intact());
    }
  }
}

}  // namespace
}  // namespace spool::format
