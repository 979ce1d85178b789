#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "lib/core/error.h"
#include "lib/core/extend.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/core/pairwise_sum.h"
#include "lib/core/random.h"
#include "lib/core/view.h"

namespace spool {
namespace {

TEST(Error, IsOneLineWhateverItQuotes) {
  const Result<void> failed =
      fail(ErrorCode::kData, "{}: cannot open", "a\nb\r\x1b[2Jc\x7f\t\u00e9");
  EXPECT_EQ(failed.error().message, "a b??[2Jc? \u00e9: cannot open");
}

TEST(Extend, SymmetricReflectsWithTheBorderTwice) {
  const int expected[] = {2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0};  // i = -4 .. 6, n = 3
  for (int i = -4; i <= 6; ++i)
    EXPECT_EQ(extend_symmetric(i, 3), expected[i + 4]) << i;
  for (int i = -9; i <= 9; ++i)
    EXPECT_EQ(extend_symmetric(i, 1), 0);
}

TEST(Extend, EveryRuleStaysInsideAndKeepsInnerIndices) {
  for (const Extension rule :
       {Extension::kSymmetric, Extension::kClamp, Extension::kPeriodic, Extension::kWhole}) {
    for (int n = 1; n <= 6; ++n) {
      for (int i = -30; i <= 30; ++i) {
        const int j = extend(i, n, rule);
        EXPECT_GE(j, 0);
        EXPECT_LT(j, n);
        if (i >= 0 && i < n) {
          EXPECT_EQ(j, i);
        }
      }
    }
  }
  EXPECT_EQ(extend(-1, 4, Extension::kWhole), 1);
  EXPECT_EQ(extend(4, 4, Extension::kWhole), 2);
  EXPECT_EQ(extend(-1, 4, Extension::kPeriodic), 3);
  EXPECT_EQ(extend(9, 4, Extension::kClamp), 3);
}

TEST(PairwiseSum, IsExactWhereEveryPartialSumIs) {
  for (const std::size_t n : {0u, 1u, 4095u, 4096u, 4097u, 100001u}) {
    const double sum = pairwise_sum(n, [](std::size_t i) { return static_cast<double>(i); });
    EXPECT_EQ(sum, n == 0 ? 0.0 : 0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
  }
}

TEST(PairwiseSum, BitsDoNotDependOnTheNumberOfThreads) {
  const auto sum = [](int threads) {
    const ThreadLimit limit(threads);
    return pairwise_sum(1000003, [](std::size_t i) { return unit_double(mix(1, i)) - 0.5; });
  };
  const double once = sum(1);
  EXPECT_EQ(sum(2), once);
  EXPECT_EQ(sum(5), once);
}

TEST(Rectangle, GrowIntersectUnite) {
  const Rectangle bounds{0, 0, 10, 8};
  EXPECT_EQ(grow({2, 2, 4, 4}, 3, 1, 0, 9, bounds), (Rectangle{0, 2, 5, 8}));
  EXPECT_TRUE(intersect({0, 0, 2, 2}, {2, 0, 4, 2}).empty());
  EXPECT_EQ(intersect({0, 0, 2, 2}, {5, 5, 6, 6}).area(), 0);
  EXPECT_EQ(unite({0, 0, 2, 2}, {5, 5, 6, 6}), (Rectangle{0, 0, 6, 6}));
  EXPECT_EQ(unite({3, 3, 3, 9}, {5, 5, 6, 6}), (Rectangle{5, 5, 6, 6}));
}

TEST(Image, IsRowMajor) {
  Plane image(3, 2);
  std::iota(image.pixels().begin(), image.pixels().end(), 0.0);
  EXPECT_EQ(image(2, 1), 5.0);
  EXPECT_EQ(image.row(1)[0], 3.0);
  EXPECT_EQ(image.index(1, 1), 4u);
}

TEST(Image, PartsAreCutOutAndPastedToWhereTheyWere) {
  Plane image(4, 3), other(4, 3, -1.0);
  std::iota(image.pixels().begin(), image.pixels().end(), 0.0);
  const Rectangle box{1, 1, 3, 3};
  const Plane part = cropped(image, box);
  EXPECT_EQ(part.bounds(), (Rectangle{0, 0, 2, 2}));
  EXPECT_EQ(part(1, 1), 10.0);
  paste(part, box, other);
  EXPECT_EQ(cropped(other, box), part);
  EXPECT_EQ(std::ranges::count(other.pixels(), -1.0), 8);
  EXPECT_TRUE(cropped(image, {4, 1, 2, 3}).empty());
  EXPECT_TRUE(cropped(Plane(), box).empty());
}

TEST(Guards, NamesAreUniqueAndCountsAddUp) {
  std::set<std::string_view> names;
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    names.insert(guard_name(static_cast<Guard>(g)));
    EXPECT_FALSE(guard_protects(static_cast<Guard>(g)).empty());
  }
  EXPECT_EQ(names.size(), kGuardCount);
  GuardCounts a, b;
  a.add(Guard::kEmptyPiece, 2);
  b.add(Guard::kEmptyPiece);
  b.add(Guard::kZeroWeight, 5);
  a += b;
  EXPECT_EQ(a[Guard::kEmptyPiece], 3u);
  EXPECT_EQ(a[Guard::kZeroWeight], 5u);
  EXPECT_NE(a, b);
}

enum class Colour { kRed, kBlue };
struct Options {
  double alpha = 0.5;
  int levels = 4;
  Colour colour = Colour::kRed;
  bool fast = false;
};
const OptionTable<Options> kTable = {
    number_option("alpha", &Options::alpha, 0.0, 1.0, "a share"),
    integer_option("levels", &Options::levels, 1, 8, "levels"),
    choice_option<Options, Colour>("colour", &Options::colour,
                                   {{"red", Colour::kRed}, {"blue", Colour::kBlue}}, "a colour"),
    switch_option("fast", &Options::fast, "quickly"),
};

TEST(OptionTable, ReadsBackWhatItWrites) {
  Options options;
  options.alpha = 0.1;
  options.levels = 7;
  options.colour = Colour::kBlue;
  options.fast = true;
  const auto copy = with_options(kTable, Options{}, option_values(kTable, options));
  ASSERT_TRUE(copy.has_value());
  EXPECT_EQ(copy->alpha, 0.1);
  EXPECT_EQ(copy->levels, 7);
  EXPECT_EQ(copy->colour, Colour::kBlue);
  EXPECT_TRUE(copy->fast);
}

TEST(OptionTable, RefusesWhatIsOutsideAndSaysWhy) {
  Options options;
  for (const auto& [name, value] : OptionValues{{"alpha", "1.5"},
                                                {"alpha", "nan"},
                                                {"alpha", "0.5x"},
                                                {"alpha", ""},
                                                {"levels", "0"},
                                                {"levels", "2.5"},
                                                {"colour", "green"},
                                                {"fast", "yes"}}) {
    const auto set = set_option(kTable, options, name, value);
    ASSERT_FALSE(set.has_value()) << name << "=" << value;
    EXPECT_EQ(set.error().code, ErrorCode::kUsage);
    EXPECT_NE(set.error().message.find(name), std::string::npos);
  }
  const auto large = set_option(kTable, options, "levels", "9999999999999999999");
  EXPECT_NE(large.error().message.find("9999999999999999999 is outside"), std::string::npos);
  const auto unknown = set_option(kTable, options, "alhpa", "0.5");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().message.find("did you mean 'alpha'"), std::string::npos);
}

TEST(OptionTable, InfinityIsReadWhereTheRangeIsOpen) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(*parse_number("x", "inf", 0.0, inf), inf);
  EXPECT_FALSE(parse_number("x", "inf", 0.0, 1.0).has_value());
  EXPECT_EQ(*parse_number("x", "1e-3", 0.0, inf), 1e-3);
}

TEST(NearestName, FindsTyposAndIgnoresStrangers) {
  EXPECT_EQ(nearest_name("unifrom", {"mitchell", "uniform"}), "uniform");
  EXPECT_EQ(nearest_name("zzzzzzzzz", {"mitchell", "uniform"}), "");
  EXPECT_EQ(nearest_name("K", {"P", "alpha", "levels"}), "levels");  // as version 0.1.0 called it
  EXPECT_EQ(nearest_name("K", {"alpha"}), "");
  EXPECT_EQ(nearest_name("direct", {"correct", "directional"}), "directional");  // its beginning
  EXPECT_EQ(nearest_name("", {"alphabetical"}), "");
}

TEST(Views, CollectOnlyWhatWasAskedFor) {
  Views views({"f", "P.1"});
  for (const char* name : {"f.0", "f.1", "P.0", "P.1", "g"})
    views.add(name, Plane(1, 1));
  std::vector<std::string> names;
  for (const View& view : views.collected())
    names.push_back(view.name);
  EXPECT_EQ(names, (std::vector<std::string>{"f.0", "f.1", "P.1"}));
  EXPECT_FALSE(Views().wants("f"));
  EXPECT_TRUE(Views({"all"}).wants("anything"));
}

}  // namespace
}  // namespace spool
