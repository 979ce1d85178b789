#include "lib/experiment/plan_cells.h"
#include "lib/experiment/plan_reader.h"
#include "lib/experiment/plan_text.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

namespace spool {
namespace {

struct ToyOptions {
  double alpha = 0.5;
  bool fast = false;
};
const OptionTable<ToyOptions> kToyTable = {
    number_option("alpha", &ToyOptions::alpha, 0.0, 1.0, "a share"),
    switch_option("fast", &ToyOptions::fast, "quickly")};

// An entry that knows the toy options and the preset "robust".
template <class Function>
Method<Function> toy(const std::string& name) {
  Method<Function> entry;
  entry.name = name;
  entry.presets = {"robust"};
  entry.make = [](std::string_view preset, const OptionValues& set) -> Result<Ready<Function>> {
    if (!preset.empty() && preset != "robust") {
      return fail(ErrorCode::kUsage, "unknown preset '{}'", preset);
    }
    SPOOL_ASSIGN(const ToyOptions options, with_options(kToyTable, ToyOptions{}, set));
    static_cast<void>(options);
    return Ready<Function>{};
  };
  return entry;
}

const MethodList<SamplerFunction> kSamplers = {
    "sampler", {toy<SamplerFunction>("uniform"), toy<SamplerFunction>("multiscale")}};
const MethodList<FilterFunction> kFilters = {"filter", {toy<FilterFunction>("box")}};

Result<Plan> parse(std::string_view text) {
  return parse_plan(text, "plan.toml", "lab", {kSamplers, kFilters});
}

constexpr std::string_view kFull = R"(
title = "sweep"
recordings = ["a.spool", "../b.spool"]
spp = [2, 4.5]
replicates = 3
seed = 9
order = "recorded"
reference = "holdout"
holdout = 12
pieces_per_side = 2
samplers = ["uniform"]
filters = "box"
[[sampler]]
name = "multiscale"
preset = ["robust", ""]
alpha = [0.25, 0.5, 1]
fast = true
[pool]
negative = "clamp0"
[metrics]
trim = 0.01
perceptual = "none"
)";

TEST(Plan, SaysEverything) {
  const auto plan = parse(kFull);
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(plan->recordings, (std::vector<std::string>{"lab/a.spool", "b.spool"}));
  EXPECT_EQ(plan->spp, (std::vector<double>{2, 4.5}));
  EXPECT_EQ(plan->replicates, 3);
  EXPECT_EQ(plan->experiment.seed, 9u);
  EXPECT_EQ(plan->experiment.order, ReplicateOrder::kRecorded);
  EXPECT_EQ(plan->experiment.reference, ReferenceKind::kHoldout);
  EXPECT_EQ(plan->experiment.holdout, 12);
  EXPECT_EQ(plan->experiment.pieces_per_side, 2);
  EXPECT_EQ(plan->rules.negative, NegativeRule::kClampToZero);
  EXPECT_EQ(plan->experiment.metrics.trim, 0.01);
  EXPECT_EQ(plan->experiment.metrics.perceptual, Perceptual::kNone);
}

TEST(Plan, SweepsAreWrittenOut) {
  const auto plan = parse(kFull);
  ASSERT_TRUE(plan.has_value());
  std::vector<std::string> labels;
  for (const MethodChoice& sampler : plan->samplers)
    labels.push_back(sampler.label());
  EXPECT_EQ(labels, (std::vector<std::string>{
                        "uniform", "multiscale:robust{alpha=0.25,fast=on}",
                        "multiscale{alpha=0.25,fast=on}", "multiscale:robust{alpha=0.5,fast=on}",
                        "multiscale{alpha=0.5,fast=on}", "multiscale:robust{alpha=1,fast=on}",
                        "multiscale{alpha=1,fast=on}"}));
  EXPECT_EQ(plan->cells().size(), 2u * 7 * 2 * 3 * 1);
}

constexpr std::string_view kLabelled = R"(
recordings = ["a.spool"]
spp = [2]
samplers = ["uniform"]
filters = "box"
[[sampler]]
name = "multiscale"
label = "ours"
preset = "robust"
alpha = 0.25
[[sampler]]
name = "multiscale"
label = "swept"
alpha = [0.5, 1]
preset = ["robust", ""]
)";

std::vector<std::string> labels_of(const std::vector<MethodChoice>& choices) {
  std::vector<std::string> labels;
  for (const MethodChoice& choice : choices)
    labels.push_back(choice.label());
  return labels;
}

TEST(Plan, LabelsNameTheirMethodsAndSweepsStayApart) {
  const auto plan = parse(kLabelled);
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(labels_of(plan->samplers),
            (std::vector<std::string>{"uniform", "ours", "swept{alpha=0.5,preset=robust}",
                                      "swept{alpha=0.5,preset=}", "swept{alpha=1,preset=robust}",
                                      "swept{alpha=1,preset=}"}));
  EXPECT_EQ(plan->samplers[1].text(), "ours=multiscale:robust{alpha=0.25}");
  const auto again = parse(plan_text(*plan));
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->samplers, plan->samplers);
}

TEST(Plan, ALabelIsPartOfACellAndNoLabelChangesNone) {
  Plan plan = *parse(kLabelled);
  Cell cell = plan.cells()[static_cast<std::size_t>(plan.replicates)];
  ASSERT_EQ(cell.sampler.label(), "ours");
  const std::string labelled = cell_id(cell, plan);
  cell.sampler.own_label = "theirs";
  EXPECT_NE(cell_id(cell, plan), labelled);
  // Ids are made of these texts: results kept before there were labels are found again.
  const Cell plain = plan.cells()[0];
  EXPECT_EQ(plain.sampler.text(), plain.sampler.label());
  cell.sampler.own_label.clear();
  EXPECT_EQ(cell.sampler.text(), "multiscale:robust{alpha=0.25}");
}

TEST(Plan, LabelsThatNameNothingOrTwoThingsAreRefused) {
  const auto refused = [](const std::string& label, const std::string& more = "") {
    const std::string text =
        "recordings = 'a'\nspp = 4\nsamplers = 'uniform'\nfilters = 'box'\n[[sampler]]\n"
        "name = 'multiscale'\nlabel = '" +
        label + "'\n" + more;
    const auto plan = parse(text);
    return plan ? std::string() : plan.error().message;
  };
  EXPECT_EQ(refused("ours"), "");
  EXPECT_NE(refused("").find("a label is empty"), std::string::npos) << refused("");
  for (const char* label : {"a b", "a/b", "a=b", "a,b", "-a", ".a", "a:b", "\u00e4", "a{b", "{a}"})
    EXPECT_NE(refused(label).find("label '"), std::string::npos) << label << refused(label);
  EXPECT_NE(refused(std::string(65, 'a')).find("1 to 64"), std::string::npos);
  EXPECT_NE(refused("ours{alpha=0.5}", "alpha = 0.25\n").find("was not chosen"), std::string::npos);
  EXPECT_NE(refused("uniform").find("is the name of a sampler"), std::string::npos);
  const std::string twice =
      refused("ours", "[[sampler]]\nname = 'multiscale'\nalpha = 1\nlabel = 'ours'\n");
  EXPECT_NE(twice.find("sampler ours is there twice"), std::string::npos) << twice;
}

TEST(Plan, RecordingsOfOneSceneAreGrouped) {
  const char* const text = R"(
recordings = "alone.spool"
spp = 4
samplers = "uniform"
filters = "box"
energy_band = [0.98, 1.02]
[[dump]]
file = "a.spool"
group = "chess"
[[dump]]
file = "apart.spool"
[[dump]]
file = "b.spool"
group = "chess"
)";
  const auto plan = parse(text);
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(plan->experiment.order, ReplicateOrder::kDisjoint);
  EXPECT_EQ(plan->replicates, 8);
  EXPECT_EQ(plan->energy_band, (std::pair{0.98, 1.02}));
  const std::vector<PlanScene> scenes = scenes_of(*plan);
  ASSERT_EQ(scenes.size(), 3u);
  EXPECT_EQ(scenes[1].group, "chess");
  ASSERT_EQ(scenes[1].recordings.size(), 2u);
  EXPECT_TRUE(scenes[1].recordings[1].ends_with("b.spool"));
  EXPECT_TRUE(scenes[2].recordings[0].ends_with("apart.spool"));
  const auto again = parse(plan_text(*plan).c_str());
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->groups, plan->groups);
  EXPECT_EQ(again->energy_band, plan->energy_band);
}

TEST(Plan, ClaimsAreReadWrittenAndRead) {
  const char* const text = R"(
recordings = "a.spool"
spp = [4, 8]
samplers = ["uniform", "multiscale"]
filters = "box"
threads = [1, 2]
[[claim]]
better = "multiscale + box"
than = "uniform + box"
[[claim]]
better = "multiscale + box"
than = "multiscale + box"
threads = 2
than_threads = 1
metric = "seconds_sampling"
[[claim]]
text = "own words"
better = "multiscale + box"
than = "uniform + box"
metric = "mse"
spp = 8
samples = "fresh"
below = 1.1
source = "LiuZheng, Figure 12"
[[claim]]
better = "multiscale + box"
than = "uniform + box"
metric = "mse"
spp = 4
samples = "fresh"
below = 1.1
)";
  const auto plan = parse(text);
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  ASSERT_EQ(plan->claims.size(), 4u);
  EXPECT_EQ(plan->claims[0].metric, "relmse");
  EXPECT_TRUE(plan->claims[0].asks(4, 1) && plan->claims[0].asks(8, 2));
  EXPECT_FALSE(plan->claims[1].asks(4, 1));
  EXPECT_TRUE(plan->claims[1].asks(4, 2));
  EXPECT_FALSE(plan->claims[2].asks(4, 1));
  EXPECT_EQ(plan->claims[2].below, 1.1);
  EXPECT_TRUE(plan->experiment.fresh);
  const auto again = parse(plan_text(*plan).c_str());
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->claims, plan->claims);
}

TEST(Plan, MistakesAreNamedWithTheirLine) {
  const std::string good =
      "recordings = 'a.spool'\nspp = 4\nsamplers = 'uniform'\nfilters = 'box'\n";
  ASSERT_TRUE(parse(good).has_value());
  const std::map<std::string, std::string> mistakes = {
      {"replicate = 3", "plan.toml:5: unknown key 'replicate', did you mean 'replicates'?"},
      {"replicates = 0", "plan.toml:5: option replicates: 0 is outside"},
      {"replicates = 2.5", "plan.toml:5: option replicates: '2.5' is not a whole number"},
      {"reference = 'holdut'", "plan.toml:5: unknown reference 'holdut', did you mean 'holdout'?"},
      {"energy_band = [1.02, 0.98]", "plan.toml:5: energy_band: the lower ratio comes first"},
      {"energy_band = 0.9", "plan.toml:5: energy_band is two ratios"},
      {"[[claim]]\nbetter = 'uniform + bxo'",
       "plan.toml:6: unknown method of the plan 'uniform + bxo', did you mean 'uniform + box'?"},
      {"[[claim]]\nbetter = 'uniform + box'", "plan.toml:5: a claim needs two methods"},
      {"threads = [1, 2]\n[[claim]]\nthreads = 3",
       "plan.toml:7: threads 3 is no number of threads of the plan"},
      {"threads = [1, 2]\n[[claim]]\nthreads = 2", "plan.toml:6: threads and than_threads"},
      {"threads = [1, 2]\n[[claim]]\nthreads = 2\nthan_threads = 2\nbetter = 'uniform + box'\nthan "
       "= "
       "'uniform + box'",
       "plan.toml:6: a claim needs two methods"},
      {"[[sampler]]\nname = 'multiscale'\n[[claim]]\nbetter = 'uniform + box'\nthan = 'multiscale "
       "+ "
       "box'\nspp = 4\n[[claim]]\ntext = 'x'\nbetter = 'uniform + box'\nthan = 'multiscale + "
       "box'",
       "plan.toml:11: this claim is there twice: ask it once"},
      {"[[claim]]\nspp = [4, 4]", "plan.toml:6: spp 4 is there twice"},
      {"[[claim]]\nmetrik = 'mse'", "plan.toml:6: unknown key of a claim 'metrik'"},
      {"[[claim]]\nmetric = 'mes'",
       "plan.toml:6: unknown metric of a claim 'mes', did you mean 'mse'?"},
      {"[[claim]]\nmetric = 'ssim'", "unknown metric of a claim 'ssim': one of relmse, mse, "},
      {"[[claim]]\nspp = 5", "plan.toml:6: spp 5 is no budget of the plan"},
      {"[[claim]]\nsamples = 'new'", "plan.toml:6: samples is own or fresh, not 'new'"},
      {"[[claim]]\nbelow = 0", "plan.toml:6: option below: 0 is outside"},
      {"[[dump]]\ngroup = 'g'", "plan.toml:5: this recording has no file"},
      {"[[dump]]\nfle = 'b.spool'",
       "plan.toml:6: unknown key of a recording 'fle', did you mean 'file'?"},
      {"order = 'random'", "plan.toml:5: order is disjoint, shuffled or recorded"},
      {"[[sampler]]\nname = 'multiscal'",
       "plan.toml:5: unknown sampler 'multiscal', did you mean 'multiscale'?"},
      {"[[sampler]]\nname = 'multiscale'\nalhpa = 0.5",
       "plan.toml:7: sampler multiscale: unknown option 'alhpa', did you mean 'alpha'?"},
      {"[[sampler]]\nname = 'multiscale'\nalpha = [0.5, 7]", "option alpha: 7 is outside"},
      {"[[sampler]]\nname = 'multiscale'\npreset = 'x'", "unknown preset 'x'"},
      {"[[sampler]]\nname = 'multiscale'\nalpha = []", "'alpha' has no value"},
      {"[[sampler]]\nalpha = 1", "this sampler has no name"},
      {"[[sampler]]\nname = 'uniform'", "sampler uniform is there twice"},
      {"[[mask]]\nname = 'm'\nfile = 'm.exr'\nrecording = 'c.spool'",
       "plan.toml:5: unknown recording of the plan 'c.spool'"},
      {"[[mask]]\nname = 'm'\nfile = 'm.exr'\n[[mask]]\nname = 'm'\nfile = 'n.exr'",
       "plan.toml:8: mask m is there twice"},
      {"threads = [1, 1]", "plan.toml:5: threads 1 is there twice"},
      {"threads = []", "plan.toml:5: 'threads' has no value"},
      {"repeats = 0", "plan.toml:5: option repeats: 0 is outside"},
      {"pictures = 3", "plan.toml:5: pictures is true or false"},
      {"[pool]\nnegativ = 1", "plan.toml:6: unknown option 'negativ'"},
      {"[[sampler]]\nname = \"multiscale\"\nepochs = 3\nalpha = 7\n", "plan.toml:8: "},
      {"metrics = ['ssim', 'flip']", "plan.toml:5: unknown metric 'flip'"},
      {"metrics = []", "plan.toml:5: no metric: leave it out for all of them"},
      {"[metrics]\nonly = 'relmsee'",
       "plan.toml:6: unknown metric 'relmsee', did you mean 'relmse'?"},
      {"[metrics]\ntrim = 'x'", "plan.toml:6: option trim: 'x' is not a number"},
      {"seed = {}", "a number, a text or true/false"},
      {"seed = = 3", "plan.toml:5:"},
  };
  for (const auto& [line, message] : mistakes) {
    const auto plan = parse(good + line);
    ASSERT_FALSE(plan.has_value()) << line;
    EXPECT_EQ(plan.error().code, ErrorCode::kUsage);
    EXPECT_NE(plan.error().message.find(message), std::string::npos)
        << line << "\n  gave " << plan.error().message;
  }
  EXPECT_FALSE(parse("").has_value());
  EXPECT_FALSE(
      parse("recordings = 'a'\nspp = []\nsamplers = 'uniform'\nfilters = 'box'").has_value());
  EXPECT_FALSE(parse("recordings = 'a'\nspp = 4\nfilters = 'box'").has_value());
}

TEST(Plan, MetricsThatItNamesComeBesideThoseOfTablesAndClaims) {
  const std::string base =
      "recordings = 'a.spool'\nspp = 4\nsamplers = ['uniform', 'multiscale']\nfilters = 'box'\n";
  const auto wanted = [](const Plan& plan) {
    std::set<std::string> names;
    for (std::size_t m = 0; m < plan.experiment.metrics.wanted.size(); ++m)
      if (plan.experiment.metrics.wanted[m]) names.insert(metrics()[m].name);
    return names;
  };
  const Plan all = *parse(base);
  EXPECT_TRUE(wanted(all).empty());
  const std::string claim =
      "[[claim]]\nbetter = 'multiscale + box'\nthan = 'uniform + box'\nmetric = 'smape'\n";
  const Plan some = *parse(base + "metrics = ['ssim']\n" + claim);
  EXPECT_EQ(wanted(some),
            (std::set<std::string>{"relmse", "mse", "energy_ratio", "ssim", "smape"}));
  const Plan table = *parse(base + claim + "[metrics]\ntrim = 0.01\nonly = ['ssim']\n");
  EXPECT_EQ(wanted(table), wanted(some));
  EXPECT_EQ(table.experiment.metrics.trim, 0.01);
  EXPECT_EQ(wanted(*parse(plan_text(table))), wanted(some));
  EXPECT_NE(cell_id(some.cells()[0], some), cell_id(all.cells()[0], all));
  const Plan counts = *parse(base + "metrics = ['ssim']\n[[claim]]\nbetter = 'multiscale + box'\n" +
                             "than = 'uniform + box'\nmetric = 'block_jump'\n");
  EXPECT_EQ(wanted(counts), (std::set<std::string>{"relmse", "mse", "energy_ratio", "ssim"}));
}

TEST(Plan, RecordingsWithOneNameAreRefused) {
  const std::string rest = "\nspp = 4\nsamplers = 'uniform'\nfilters = 'box'\n";
  for (const char* recordings :
       {"recordings = ['a/x.spool', 'b/x.spool']", "recordings = ['a.spool', 'a.spool']"}) {
    EXPECT_FALSE(parse(recordings + rest).has_value()) << recordings;
  }
  EXPECT_FALSE(
      parse("recordings = 'a'\nspp = [4, 4]\nsamplers = 'uniform'\nfilters = 'box'").has_value());
}

TEST(Plan, MethodsWithAnArgumentAreWrittenInFull) {
  const std::string text =
      "recordings = 'a.spool'\nspp = 4\nsamplers = 'exec:python3 mine.py {a=1}'\nfilters = 'box'\n";
  EXPECT_FALSE(parse(text).has_value());
  MethodList<SamplerFunction> samplers = kSamplers;
  std::string asked;
  Method<SamplerFunction> exec;
  exec.name = "exec";
  exec.argument = "COMMAND";
  exec.make = [&](std::string_view argument, const OptionValues&) -> Result<ReadySampler> {
    asked = argument;
    return ReadySampler{};
  };
  samplers.methods.push_back(exec);
  const auto plan = parse_plan(text, "plan.toml", "lab", {samplers, kFilters});
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(asked, "python3 mine.py {a=1}");
  EXPECT_EQ(plan->samplers[0].label(), "mine");
  const auto again = parse_plan(plan_text(*plan), "plan.toml", "lab", {samplers, kFilters});
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->samplers, plan->samplers);
}

TEST(Plan, ItsTextReadsBackToTheSameCells) {
  Plan plan = *parse(kFull);
  plan.threads = {1, 4};
  plan.experiment.repeats = 3;
  plan.pictures = false;
  const auto again = parse(plan_text(plan));
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->threads, plan.threads);
  EXPECT_FALSE(again->pictures);
  const std::vector<Cell> cells = plan.cells(), others = again->cells();
  ASSERT_EQ(others.size(), cells.size());
  std::set<std::string> ids, other_ids;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ids.insert(cell_id(cells[i], plan));
    other_ids.insert(cell_id(others[i], *again));
  }
  EXPECT_EQ(other_ids, ids);
}

TEST(Plan, MissingFileIsAnIoError) {
  const auto plan = read_plan("no/such/plan.toml", {kSamplers, kFilters});
  ASSERT_FALSE(plan.has_value());
  EXPECT_EQ(plan.error().code, ErrorCode::kIo);
}

TEST(Plan, CellIdsAreUniqueAndFollowWhatDecidesTheResult) {
  const Plan plan = *parse(kFull);
  std::set<std::string> ids;
  for (const Cell& cell : plan.cells())
    ids.insert(cell_id(cell, plan));
  EXPECT_EQ(ids.size(), plan.cells().size());
  const Cell cell = plan.cells()[5];
  Plan other = plan;
  other.title = "renamed";
  other.replicates = 50;
  EXPECT_EQ(cell_id(cell, other), cell_id(cell, plan));
  other.experiment.seed = 10;
  EXPECT_NE(cell_id(cell, other), cell_id(cell, plan));
  other = plan;
  other.experiment.metrics.trim = 0.0;
  EXPECT_NE(cell_id(cell, other), cell_id(cell, plan));
  Cell moved = cell;
  moved.dump = "elsewhere/" + std::filesystem::path(cell.dump).filename().string();
  EXPECT_EQ(cell_id(moved, plan), cell_id(cell, plan));
}

}  // namespace
}  // namespace spool
