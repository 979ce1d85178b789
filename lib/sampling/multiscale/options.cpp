#include "lib/sampling/multiscale/options.h"

namespace spool {
namespace {

using O = MultiscaleOptions;

// What is analysed: eqs 1-4 and 6.
OptionTable<O> analysis_options() {
  OptionTable<O> table = {
      init_spp_option<O>(&O::init_spp),
      expert(choice_option<O, ExposureMode>(
          "exposure", &O::exposure,
          {{"normalise", ExposureMode::kNormalise}, {"none", ExposureMode::kNone}},
          "scale of the analysis signal, frozen after the initial samples")),
      choice_option<O, AnalysedChannels>(
          "analysis_channel", &O::channels,
          {{"luminance", AnalysedChannels::kLuminance},
           {"max_rgb", AnalysedChannels::kMaxRgb},
           {"per_channel", AnalysedChannels::kPerChannel}},
          "what is analysed; per_channel takes the largest priority"),
      expert(choice_option<O, ContrastForm>(
          "contrast", &O::contrast,
          {{"guarded", ContrastForm::kGuarded}, {"literal", ContrastForm::kLiteral}},
          "contrast of eq 6")),
  };
  append_options(table, pyramid_option_table(), &O::pyramid);
  return table;
}

// Where the samples go: eqs 5, 7, 8 and 13.
OptionTable<O> sampling_options() {
  return {
      expert(
          choice_option<O, DetailIndex>("d_index", &O::detail_index,
                                        {{"produced_with_level", DetailIndex::kProducedWithLevel},
                                         {"same_k", DetailIndex::kSameK}},
                                        "which detail image a level looks at: d_(k-1) or d_k")),
      expert(choice_option<O, DetailNorm>(
          "d_norm", &O::detail_norm,
          {{"absolute", DetailNorm::kAbsolute},
           {"relative", DetailNorm::kRelative},
           {"off", DetailNorm::kOff}},
          "difference term of eq 5: d^2, d^2 / (f^2 + 0.01), or none")),
      number_option<O>("alpha", &O::alpha, 0.0, 1.0, "weight of the newest change in eq 7"),
      expert(choice_option<O, AttenuationUpdate>("A_update", &O::attenuation,
                                                 {{"fractional", AttenuationUpdate::kFractional},
                                                  {"region", AttenuationUpdate::kRegion},
                                                  {"any_touch", AttenuationUpdate::kAnyTouch},
                                                  {"accumulate", AttenuationUpdate::kAccumulate},
                                                  {"none", AttenuationUpdate::kNone}},
                                                 "reading of eq 7")),
      number_option<O>("explore_fraction", &O::explore_fraction, 0.0, 1.0,
                       "share of the adaptive budget spent uniformly before the loop"),
      choice_option<O, UpdateMode>("update", &O::update,
                                   {{"epoch", UpdateMode::kEpoch}, {"exact", UpdateMode::kExact}},
                                   "many regions a step, or one"),
      integer_or_word_option<O>("epochs", &O::epochs, "auto", 1, 1000000,
                                "steps of update=epoch; auto: 32"),
      expert(choice_option<O, StepCounts>(
          "step_counts", &O::step_counts,
          {{"predicted", StepCounts::kPredicted}, {"one", StepCounts::kOne}},
          "samples of a piece in a step of update=epoch: 1 to 8 by priority, or one")),
      expert(choice_option<O, ParallelOver>(
          "parallel", &O::parallel,
          {{"rows", ParallelOver::kRows}, {"tiles", ParallelOver::kTiles}},
          "what runs in parallel; never changes a result")),
      integer_option<O>("tile", &O::tile, 0, 65536,
                        "pieces per tile side, a multiple of 2^levels; 0: no tiles"),
      expert(choice_option<O, TileHalo>("tile_halo", &O::tile_halo,
                                        {{"frozen", TileHalo::kFrozen}, {"none", TileHalo::kNone}},
                                        "what a tile uses of its neighbours")),
      expert(choice_option<O, BudgetBase>(
          "budget_base", &O::budget_base,
          {{"adaptive", BudgetBase::kAdaptive}, {"total", BudgetBase::kTotal}},
          "what eq 13 divides among the tiles")),
  };
}

OptionTable<O> make_table() {
  OptionTable<O> table = analysis_options();
  for (const Option<O>& option : sampling_options())
    table.push_back(option);
  return table;
}

O paper_preset() {
  O options;
  options.init_spp = 1;
  options.exposure = ExposureMode::kNone;
  options.contrast = ContrastForm::kLiteral;
  options.pyramid.detail = LaplacianDetail::kPhase00;
  options.attenuation = AttenuationUpdate::kRegion;
  options.update = UpdateMode::kExact;
  options.parallel = ParallelOver::kTiles;
  options.tile = 64;
  options.tile_halo = TileHalo::kNone;
  return options;
}

}  // namespace

int epoch_count(const MultiscaleOptions& options) {
  return options.epochs.value_or(kDefaultEpochs);
}

const OptionTable<MultiscaleOptions>& multiscale_option_table() {
  static const OptionTable<MultiscaleOptions> table = make_table();
  return table;
}

const Presets<MultiscaleOptions>& multiscale_presets() {
  static const Presets<MultiscaleOptions> presets = {{"robust", {}}, {"paper", paper_preset()}};
  return presets;
}

const std::vector<Reading>& multiscale_readings() {
  static const std::vector<Reading> readings = {
      {"one_phase", "eq 4", "detail of one of the four phases", {{"detail", "phase00"}}},
      {"all_phases", "eq 4", "detail averaged over the phases", {{"detail", "cycle_spun"}}},
      {"radiance", "eq 5", "V and d^2 as they are", {{"exposure", "none"}}},
      {"exposed", "eq 5", "radiance in units of its mean", {{"exposure", "normalise"}}},
      {"accumulate",
       "eqs 7, 8",
       "the printed word: A sums the changes",
       {{"A_update", "accumulate"}}},
      {"by_visit",
       "eqs 7, 8",
       "A moves by alpha at each visit of its region",
       {{"A_update", "region"}}},
      {"by_touch", "eqs 7, 8", "the same wherever f_k changed", {{"A_update", "any_touch"}}},
      {"by_pass",
       "eqs 7, 8",
       "A moves by alpha for each pass over its region",
       {{"A_update", "fractional"}}},
      {"no_attenuation", "eqs 7, 8", "A is 1", {{"A_update", "none"}}},
      {"tiled", "tiles", "tiles of 64 pieces, each alone", {{"tile", "64"}, {"tile_halo", "none"}}},
      {"untiled", "tiles", "one tile", {{"tile", "0"}}},
      {"adaptive_budget",
       "eq 13",
       "divides what the first samples left",
       {{"budget_base", "adaptive"}}},
      {"whole_budget", "eq 13", "divides the whole budget", {{"budget_base", "total"}}},
  };
  return readings;
}

}  // namespace spool
