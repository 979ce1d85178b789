#include "lib/methods/method_text.h"

#include <gtest/gtest.h>

namespace spool {
namespace {

TEST(MethodText, EveryWayOfWritingAMethodIsRead) {
  using Choice = MethodChoice;
  const std::pair<const char*, Choice> cases[] = {
      {"box", {"box", "", {}}},
      {"multiscale:paper", {"multiscale", "paper", {}}},
      {"gaussian{sigma=2}", {"gaussian", "", {{"sigma", "2"}}}},
      {"m:p{a=1,b=x=y}", {"m", "p", {{"a", "1"}, {"b", "x=y"}}}},
      {"ours=m:p{a=1}", {"m", "p", {{"a", "1"}}, "ours"}},
      {"ours=m{a=1}", {"m", "", {{"a", "1"}}, "ours"}},
      {"exec:run {a=1},b", {"exec", "run {a=1},b", {}}},
      {"mine.2=exec:a=1 run", {"exec", "a=1 run", {}, "mine.2"}},
  };
  for (const auto& [text, expected] : cases) {
    const auto choice = parse_method(text, {"exec"});
    ASSERT_TRUE(choice.has_value()) << text << ": " << choice.error().message;
    EXPECT_EQ(*choice, expected) << text;
    EXPECT_EQ(choice->text(), text);
    EXPECT_EQ(choice->label(), expected.own_label.empty() ? text : expected.own_label);
  }
  for (const char* text : {"m{a=1", "m{a}", "m{=1}", "=m", "a b=m", "-=m"}) {
    const auto choice = parse_method(text, {"exec"});
    ASSERT_FALSE(choice.has_value()) << text;
    EXPECT_EQ(choice.error().code, ErrorCode::kUsage) << text;
  }
}

TEST(MethodText, CommasInBracesAndQuotesDoNotPartMethods) {
  EXPECT_EQ(split_methods("a,b:paper,c{x=1,y=2},exec:run 'p, q'"),
            (std::vector<std::string>{"a", "b:paper", "c{x=1,y=2}", "exec:run 'p, q'"}));
  EXPECT_TRUE(split_methods("").empty());
}

TEST(MethodText, TwoMethodsOfOneLabelAreRefused) {
  EXPECT_TRUE(check_distinct("filter", {{"box", "", {}}, {"box", "", {}, "mine"}}).has_value());
  const auto twice = check_distinct("filter", {{"box", "", {}, "mine"}, {"gem", "", {}, "mine"}});
  ASSERT_FALSE(twice.has_value());
  EXPECT_EQ(twice.error().message,
            "filter mine is there twice: mine=box and mine=gem: give one another label");
}

}  // namespace
}  // namespace spool
