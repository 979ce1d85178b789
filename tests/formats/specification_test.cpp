// The byte tables of formats/spool.md and formats/record_layout.h are the same.
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/record_layout.h"
#include "tests/support/source_directory.h"

namespace spool::format {
namespace {

struct Row {
  size_t offset = 0;
  std::string field;

  bool operator==(const Row&) const = default;
};
void PrintTo(const Row& row, std::ostream* out) {
  *out << row.offset << " " << row.field;
}
using Tables = std::map<std::string, std::vector<Row>>;

std::vector<std::string> lines_of(const char* file) {
  std::ifstream in(test::source_directory() / file);
  EXPECT_TRUE(in) << file;
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  return lines;
}

size_t bytes_of_type(const std::string& type) {
  static const std::regex kPattern(R"((u|char)(\d*)(?:\[(\d+)\])?)");
  std::smatch match;
  EXPECT_TRUE(std::regex_match(type, match, kPattern)) << type;
  const size_t element = match[1] == "char" ? 1 : std::stoul(match[2]) / 8;
  return element * (match[3].matched ? std::stoul(match[3]) : 1);
}

// Tables that follow a line `<!-- table: NAME -->`; each must fill 64 bytes without a gap.
Tables page_tables() {
  static const std::regex kMark(R"(<!-- table: (\w+) -->)");
  static const std::regex kRow(R"(\| (\d+) \| ([^|]+) \| `(\w+)` \|.*)");
  Tables tables;
  std::string name;
  size_t expected = 0;
  for (const std::string& line : lines_of("formats/spool.md")) {
    std::smatch match;
    if (std::regex_match(line, match, kMark)) {
      name = match[1];
      expected = 0;
    } else if (!name.empty() && std::regex_match(line, match, kRow)) {
      EXPECT_EQ(std::stoul(match[1]), expected) << name << ": " << line;
      tables[name].push_back({std::stoul(match[1]), match[3]});
      expected += bytes_of_type(match[2]);
    } else if (line.empty() && !tables[name].empty()) {
      EXPECT_EQ(expected, kUnit) << name;
      name.clear();
    }
  }
  tables.erase("");
  return tables;
}

// "PayloadCrc32" -> "payload_crc32"
std::string snake_case(const std::string& name) {
  std::string snake;
  for (char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0 && !snake.empty()) snake += '_';
    snake += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return snake;
}

Tables code_tables() {
  static const std::regex kOpen(R"(namespace (\w+) \{)");
  static const std::regex kConstant(R"(inline constexpr size_t k(\w+) = (\d+);)");
  Tables tables;
  std::string name;
  for (const std::string& line : lines_of("formats/record_layout.h")) {
    std::smatch match;
    if (std::regex_match(line, match, kOpen)) {
      name = match[1];
    } else if (line.starts_with("}")) {
      name.clear();
    } else if (!name.empty() && std::regex_match(line, match, kConstant)) {
      tables[name].push_back({std::stoul(match[2]), snake_case(match[1])});
    }
  }
  return tables;
}

TEST(Specification, ByteTablesEqualTheCode) {
  const Tables page = page_tables();
  EXPECT_EQ(page.size(), 6u);
  EXPECT_EQ(page, code_tables());
}

TEST(Specification, LimitsEqualTheCode) {
  std::ostringstream text;
  for (const std::string& line : lines_of("formats/spool.md"))
    text << line << '\n';
  const std::string page = text.str();
  const auto says = [&](const std::string& words) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  };
  says("| width, height | " + std::to_string(kMaxSide) + " each, product 2^28 |");
  EXPECT_EQ(kMaxPixels, uint64_t{1} << 28);
  says("| `spp`, `block_spp` | " + std::to_string(kMaxSpp) + ", " + std::to_string(kMaxBlockSpp));
  says("| channels, groups | " + std::to_string(kMaxChannels) + ", " + std::to_string(kMaxGroups));
  says("| `raw_bytes` of any record | " + std::to_string(kMaxRawBytes >> 20) + " MiB |");
  says("at most 2^20 - 1024 |");
  EXPECT_EQ(kMaxBlocks, (uint64_t{1} << 20) - 1024);
  says("| records | 2^20 with `INDX` |");
  EXPECT_EQ(kMaxRecords, uint64_t{1} << 20);
  says("| `meta` | " + std::to_string(kMaxMetaRecords) + " records of 1 MiB |");
  EXPECT_EQ(kMaxMetaBytes, uint64_t{1} << 20);
  says("nesting is at most " + std::to_string(kMaxMetaDepth) + " deep");
  says("window size at most " + std::to_string(kMaxZstdWindow >> 20) + " MiB");
}

}  // namespace
}  // namespace spool::format
