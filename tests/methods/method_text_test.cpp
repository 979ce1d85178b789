#include "lib/methods/method_text.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "lib/methods/method_list.h"
#include "lib/sampling/samplers.h"

namespace spool {
namespace {

OptionValues values_of(const std::vector<OptionDescription>& described) {
  OptionValues values;
  for (const OptionDescription& option : described)
    values.emplace_back(option.name, option.value);
  return values;
}

template <class Function>
void expect_readings_to_set_options(const MethodList<Function>& methods) {
  for (const Method<Function>& method : methods) {
    for (const Reading& reading : method.readings) {
      ASSERT_TRUE(method.make("paper+" + reading.name, {}).has_value()) << reading.name;
      const OptionValues now = values_of(method.describe("paper+" + reading.name));
      for (const auto& value : reading.set)
        EXPECT_EQ(std::ranges::count(now, value), 1) << reading.name << ": " << value.first;
    }
  }
}

TEST(MethodText, EveryWayOfWritingAMethodIsRead) {
  using Choice = MethodChoice;
  const std::pair<const char*, Choice> cases[] = {
      {"box", {"box", "", {}}},
      {"multiscale:paper", {"multiscale", "paper", {}}},
      {"gaussian{sigma=2}", {"gaussian", "", {{"sigma", "2"}}}},
      {"m:p{a=1,b=x=y}", {"m", "p", {{"a", "1"}, {"b", "x=y"}}}},
      {"ours=m:p{a=1}", {"m", "p", {{"a", "1"}}, "ours"}},
      {"ours=m{a=1}", {"m", "", {{"a", "1"}}, "ours"}},
      {"exec:run {a=1},b", {"exec", "run {a=1},b", {}, "", true}},
      {"mine.2=exec:a=1 run", {"exec", "a=1 run", {}, "mine.2", true}},
      {"exec{a=1,b=2}:run x}:{c=3}", {"exec", "run x}:{c=3}", {{"a", "1"}, {"b", "2"}}, "", true}},
      {"exec", {"exec", "", {}, "", true}},
      {"exec{a=1}", {"exec", "", {{"a", "1"}}, "", true}},
  };
  for (const auto& [text, expected] : cases) {
    const auto choice = parse_method(text, {"exec"});
    ASSERT_TRUE(choice.has_value()) << text << ": " << choice.error().message;
    EXPECT_EQ(*choice, expected) << text;
    EXPECT_EQ(choice->text(), text);
    EXPECT_EQ(choice->label(), expected.own_label.empty() ? text : expected.own_label);
  }
  for (const char* text :
       {"m{a=1", "m{a}", "m{=1}", "=m", "a b=m", "-=m", "exec{a=1", "exec{a}:run"}) {
    const auto choice = parse_method(text, {"exec"});
    ASSERT_FALSE(choice.has_value()) << text;
    EXPECT_EQ(choice.error().code, ErrorCode::kUsage) << text;
  }
}

TEST(Readings, SetOptionsOfTheirMethod) {
  expect_readings_to_set_options(samplers());
  expect_readings_to_set_options(filters());
}

TEST(Readings, ThoseOfThePresetPaperChangeNothing) {
  const Sampler& sampler = *find_method(samplers(), "multiscale");
  EXPECT_EQ(values_of(sampler.describe("paper+one_phase+radiance+by_visit+tiled+adaptive_budget")),
            values_of(sampler.describe("paper")));
  const Filter& filter = *find_method(filters(), "directional");
  EXPECT_EQ(
      values_of(filter.describe(
          "paper+one_phase+mean_contrast+pyramid_means+printed_factor+continuous_width+tiled")),
      values_of(filter.describe("paper")));
  EXPECT_NE(values_of(filter.describe("+variance+printed_factor")),
            values_of(filter.describe("robust")));
}

TEST(Readings, UnknownOnesAndTwoOfOneEquationAreErrors) {
  const Sampler& sampler = *find_method(samplers(), "multiscale");
  const auto message = [&](const char* preset) {
    const auto made = sampler.make(preset, {});
    return made ? std::string("made") : made.error().message;
  };
  EXPECT_EQ(message("paper+acumulate"), "unknown reading 'acumulate', did you mean 'accumulate'?");
  EXPECT_EQ(message("paper+accumulate+by_pass"),
            "'accumulate' and 'by_pass' are both readings of eqs 7, 8: choose one");
  EXPECT_NE(message("paper+"), "made");
  EXPECT_NE(message("papre+accumulate"), "made");
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

TEST(MethodText, ACommandIsCalledByItsScript) {
  const std::pair<const char*, const char*> cases[] = {
      {"./den", "den"},
      {"python3 long/path/filter.py --x {radiance}", "filter"},
      {"A=1 nice -n 10 python3.11 -u 'a b/den oise.v2.py'", "a"},
      {"python3 -m my_module", "my_module"},
      {"python3 -c 'print(1)'", "print1"},
      {"/opt/Ünnamed/-.den+{x}.sh 1", "command"},
      {"", "command"},
      {"python3", "python3"},
      {"x/.hidden", "command"},
      {"tool.v2.bin model.pth", "tool.v2"},
  };
  for (const auto& [command, name] : cases)
    EXPECT_EQ(command_name(command), name) << command;
  EXPECT_EQ(command_name(std::string(500, 'a')).size(), 32u);
}

TEST(MethodText, CommandsGetShortLabelsOfTheirOwn) {
  MethodList<FilterFunction> list{"filter", {}};
  for (const char* name : {"box", "exec"}) {
    list.methods.emplace_back().name = name;
    list.methods.back().argument = name == std::string("exec") ? "COMMAND" : "";
  }
  std::vector<MethodChoice> choices = {{"exec", "a/den.py", {}},
                                       {"exec", "b/den.py", {}, ""},
                                       {"box", "", {}, "den"},
                                       {"exec", "./box", {}},
                                       {"exec", "c/den.py", {{"t", "9"}}},
                                       {"exec", "d/den.py", {{"t", "9"}}},
                                       {"exec", "./x", {}, "own_label"}};
  label_commands(list, choices);
  std::vector<std::string> labels;
  for (const MethodChoice& choice : choices) {
    labels.push_back(choice.label());
    EXPECT_TRUE(check_own_label(list, choice).has_value()) << choice.label();
  }
  EXPECT_EQ(labels, (std::vector<std::string>{"den_2", "den_3", "den", "box_2", "den{t=9}",
                                              "den_2{t=9}", "own_label"}));
  const std::vector<MethodChoice> once = choices;
  label_commands(list, choices);
  EXPECT_EQ(choices, once);
}

}  // namespace
}  // namespace spool
