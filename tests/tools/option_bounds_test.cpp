// A program on the library that hands a verb a wrong number gets the error of the command line:
// each verb looks at its options in validate(), before it reads or writes anything.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tools/show/show.h"
#include "tools/verbs/compare.h"
#include "tools/verbs/evaluate.h"
#include "tools/verbs/figure.h"
#include "tools/verbs/metrics.h"
#include "tools/verbs/picture.h"
#include "tools/verbs/pixel.h"
#include "tools/verbs/reconstruct.h"
#include "tools/verbs/replay.h"
#include "tools/verbs/report.h"
#include "tools/verbs/synth.h"
#include "tools/view/view.h"

namespace spool::tools {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Options, class Number>
void expect_refused(const Options& good, Number Options::* number, std::vector<double> values) {
  ASSERT_TRUE(validate(good).has_value()) << validate(good).error().message;
  for (const double value : values) {
    Options wrong = good;
    wrong.*number = static_cast<Number>(value);
    const Result<void> result = validate(wrong);
    ASSERT_FALSE(result.has_value()) << value;
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
    EXPECT_NE(result.error().message.find("is outside"), std::string::npos)
        << result.error().message;
  }
}

TEST(OptionBounds, NumbersOfResults) {
  expect_refused(CompareOptions{}, &CompareOptions::significance, {-1, 1.5, kNaN, kInfinity});
  expect_refused(CompareOptions{}, &CompareOptions::tolerance, {-1e-9, 1e308, kNaN, kInfinity});
  expect_refused(FigureOptions{}, &FigureOptions::spp, {-1, 1e308, kNaN, kInfinity});
  expect_refused(FigureOptions{}, &FigureOptions::column, {-1, 3, 2147483647});
  expect_refused(ReportOptions{}, &ReportOptions::max_image_mb, {-1, 1e308, kNaN, kInfinity});
  expect_refused(ViewOptions{}, &ViewOptions::port, {-1, 65536, 2147483647});
}

TEST(OptionBounds, NumbersOfPictures) {
  PictureOptions picture;
  picture.output = "a.png";
  expect_refused(picture, &PictureOptions::exposure, {-101, 1e308, kNaN, kInfinity});
  ShowOptions show;
  show.output = "a.html";
  ASSERT_TRUE(validate(show).has_value());
  expect_refused(ShowSettings{}, &ShowSettings::exposure, {-101, 1e308, kNaN, kInfinity});
  expect_refused(ShowSettings{}, &ShowSettings::most_mb, {-1, 0, 1e308, kNaN, kInfinity});
  show.settings.most_mb = kNaN;
  EXPECT_FALSE(validate(show).has_value());
}

TEST(OptionBounds, NumbersOfReplays) {
  ReplayOptions replay;
  replay.spp = 4;
  expect_refused(replay, &ReplayOptions::spp, {-1, 0, 1e308, kNaN, kInfinity});
  ReconstructOptions reconstruct;
  expect_refused(reconstruct, &ReconstructOptions::spp, {-1, 65537, 2147483647});
  SynthOptions synth;
  synth.size = "8";
  expect_refused(synth, &SynthOptions::spp, {-1, 0, 65537});
  PoolOptions pool;
  expect_refused(pool, &PoolOptions::holdout, {-1, 65536});
  expect_refused(pool, &PoolOptions::pieces_per_side, {-1, 0, 3});
}

TEST(OptionBounds, WordsAreLookedAtToo) {
  CompareOptions compare;
  compare.metrics = "msee";
  EXPECT_FALSE(validate(compare).has_value());
  MetricsOptions metrics;
  ASSERT_TRUE(validate(metrics).has_value());
  for (const char* setting :
       {"trim=nan", "trim=-1", "rel_eps=inf", "rel_scale=some", "x=1", "trim"}) {
    metrics.settings = {setting};
    EXPECT_FALSE(validate(metrics).has_value()) << setting;
  }
  PictureOptions picture;
  picture.output = "a.png";
  for (const char* range : {"1", "2,1", "nan,1", "0,inf", "1,2,3"}) {
    picture.range = range;
    EXPECT_FALSE(validate(picture).has_value()) << range;
  }
}

}  // namespace
}  // namespace spool::tools
