#include "formats/bounded_json.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace spool::format {
namespace {

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(BoundedJson, TakesTheLargestDepthAndNoMore) {
  EXPECT_TRUE(parse_json(nested(kMaxJsonDepth)).is_array());
  EXPECT_TRUE(parse_json(nested(kMaxJsonDepth + 1)).is_discarded());
  EXPECT_TRUE(parse_json(nested(1'000'000)).is_discarded());
  EXPECT_TRUE(
      parse_json<nlohmann::ordered_json>(R"({"a":)" + nested(100'000) + "}").is_discarded());
}

TEST(BoundedJson, BracketsInStringsAreText) {
  const std::string brackets(1000, '[');
  EXPECT_TRUE(parse_json("[\"" + brackets + "\"]").is_array());
  EXPECT_TRUE(parse_json("[\"\\\"" + brackets + "\"]").is_array());
  // A string that ends where it seems not to.
  EXPECT_TRUE(parse_json("[\"\\\\\"," + nested(100) + "]").is_discarded());
}

TEST(BoundedJson, NothingStandsBehindAByte0) {
  using namespace std::string_view_literals;
  EXPECT_TRUE(parse_json("{}\0"sv).is_discarded());
  EXPECT_TRUE(parse_json("{\"a\": 1}\0[["sv).is_discarded());
  EXPECT_TRUE(parse_json("[\"a\0b\"]"sv).is_discarded());
  EXPECT_TRUE(parse_json("[\"a\\u0000b\"]"sv).is_array());
}

// Side by side is not one in another.
TEST(BoundedJson, ManyShallowValuesAreTaken) {
  std::string text = "[[]";
  for (int i = 0; i < 1000; ++i)
    text += ",[{}]";
  EXPECT_EQ(parse_json(text + "]").size(), 1001u);
}

TEST(BoundedJson, TheLengthIsBounded) {
  EXPECT_TRUE(parse_json("[1]", 3).is_array());
  EXPECT_TRUE(parse_json("[12]", 3).is_discarded());
}

TEST(BoundedJson, FilesThatAreAbsentLongOrNoFilesAreDiscarded) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "a.json") << "{\"a\": 1}";
  EXPECT_EQ(parse_json_file(folder / "a.json")["a"], 1);
  EXPECT_TRUE(parse_json_file(folder / "a.json", 7).is_discarded());
  EXPECT_TRUE(parse_json_file(folder / "b.json").is_discarded());
  EXPECT_TRUE(parse_json_file(folder / ".").is_discarded());
}

}  // namespace
}  // namespace spool::format
