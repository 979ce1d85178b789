#include "lib/experiment/toml_nesting.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace spool {
namespace {

std::string key_of(std::size_t parts) {
  std::string key = "a";
  for (std::size_t i = 1; i < parts; ++i)
    key += i % 2 == 0 ? ".\"b.b\"" : " . a";
  return key;
}

TEST(TomlNesting, CountsPartsOfKeysWhereverTheyStand) {
  const std::string deep = key_of(kMaxTomlDepth + 2), flat = key_of(kMaxTomlDepth + 1);
  for (const std::string before :
       {"", "x = 1\n", "x = \"\"\"\n. \\\"\"\"\"\"\n", "x = 'a\"'\n", "# \"\n"}) {
    const std::size_t line =
        static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
    EXPECT_EQ(line_nested_too_deeply(before + deep + " = 1\n"), line) << before;
    EXPECT_EQ(line_nested_too_deeply(before + "[" + deep + "]\n"), line) << before;
    EXPECT_EQ(line_nested_too_deeply(before + "t = {" + deep + " = 1}\n"), line) << before;
    EXPECT_EQ(line_nested_too_deeply(before + flat + " = 1\n[" + flat + "]\n"), 0u) << before;
  }
  EXPECT_EQ(line_nested_too_deeply("t = {x = \"\"\"\"\"\"\"\", " + deep + " = 1}"), 1u);
  EXPECT_EQ(line_nested_too_deeply("t = {x = '''a'''', " + deep + " = 1}"), 1u);
}

TEST(TomlNesting, CountsBracketsOneInAnother) {
  const std::string open(kMaxTomlDepth, '['), closed(kMaxTomlDepth, ']');
  EXPECT_EQ(line_nested_too_deeply("a = " + open + closed), 0u);
  EXPECT_EQ(line_nested_too_deeply("a = " + open + closed + "\nb = " + open + closed), 0u);
  EXPECT_EQ(line_nested_too_deeply("\na = " + open + "{" + closed), 2u);
}

TEST(TomlNesting, DotsOfNumbersTextsAndCommentsAreNone) {
  std::string list = "spp = [";
  for (int i = 0; i < 1000; ++i)
    list += "0.5, ";
  EXPECT_EQ(line_nested_too_deeply(list + "1.0]\n"), 0u);
  const std::string dots(1000, '.'), brackets(1000, '[');
  EXPECT_EQ(line_nested_too_deeply("a = \"" + dots + brackets + "\"\n# " + dots + brackets), 0u);
  EXPECT_EQ(line_nested_too_deeply("a = '" + dots + "'\nb = '''\n" + brackets + "\n'''\n"), 0u);
}

TEST(TomlNesting, TakesWhatEndsAnywhere) {
  for (const char* text :
       {"", "\"", "'", "\"\"\"", "'''", "\"\\", "#", "a = \"\"\"\\", "]]]]", "\"\"\"\""})
    EXPECT_EQ(line_nested_too_deeply(text), 0u) << text;
}

}  // namespace
}  // namespace spool
