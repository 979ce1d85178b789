#include "lib/filters/directional/options.h"

#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

constexpr double kLargestFactor = 1e6;

// "const(0.5)", or the name of a rule.
Option<FilterSizeOptions> size_factor_option() {
  static const std::vector<std::pair<std::string, SizeFactorRule>> rules = {
      {"literal_clamped", SizeFactorRule::kLiteralClamped},
      {"literal", SizeFactorRule::kLiteral},
      {"greedy", SizeFactorRule::kGreedy},
      {"inverse", SizeFactorRule::kInverse}};
  static constexpr const char* kAllowed = "const(Z)|literal_clamped|literal|greedy|inverse";
  return {
      "size_factor", kAllowed, "weight of the squared difference in eq 9",
      [](FilterSizeOptions& options, std::string_view text) -> Result<void> {
        for (const auto& [name, rule] : rules) {
          if (text == name) {
            options.factor.rule = rule;
            return {};
          }
        }
        if (text.starts_with("const(") && text.ends_with(")")) {
          SPOOL_ASSIGN(const double z, parse_number("size_factor", text.substr(6, text.size() - 7),
                                                    0.0, kLargestFactor));
          options.factor = {SizeFactorRule::kConstant, z};
          return {};
        }
        return fail(ErrorCode::kUsage, "option size_factor: '{}' is not one of {}", text, kAllowed);
      },
      [](const FilterSizeOptions& options) -> std::string {
        for (const auto& [name, rule] : rules) {
          if (rule == options.factor.rule) return name;
        }
        return fmt::format("const({})", format_number(options.factor.constant));
      }};
}

OptionTable<FilterSizeOptions> filter_size_option_table() {
  using O = FilterSizeOptions;
  return {
      choice_option<O, SizeChannels>(
          "analysis_channel", &O::channels,
          {{"of_selection", SizeChannels::kOfSelection},
           {"luminance", SizeChannels::kLuminance},
           {"max_rgb", SizeChannels::kMaxRgb},
           {"per_channel", SizeChannels::kPerChannel}},
          "what decides: the sampler's signal, or another; per_channel: eq 9's mean over channels"),
      expert(choice_option<O, SizeVariance>(
          "size_variance", &O::variance,
          {{"coarse_var", SizeVariance::kCoarseVariance}, {"contrast", SizeVariance::kContrast}},
          "S of eq 9: variance of the mean, or the contrast of eq 6")),
      expert(choice_option<O, ContrastForm>(
          "contrast", &O::contrast,
          {{"guarded", ContrastForm::kGuarded}, {"literal", ContrastForm::kLiteral}},
          "contrast of a piece's samples")),
      expert(choice_option<O, SizeCoarse>(
          "size_coarse", &O::coarse, {{"box", SizeCoarse::kBox}, {"pyramid", SizeCoarse::kPyramid}},
          "q of eq 9: mean over the region, or the pyramid's value")),
      size_factor_option(),
      expert(number_option<O>("size_factor_fallback", &O::factor_fallback, 0.0, kLargestFactor,
                              "value where the attenuation is undefined")),
      expert(switch_option<O>("track_a0", &O::track_a0,
                              "use A_0 as the sampler tracked it instead of A_1")),
      expert(choice_option<O, SizeSmooth>("size_smooth", &O::smooth,
                                          {{"opens_only", SizeSmooth::kOpensOnly},
                                           {"on", SizeSmooth::kOn},
                                           {"off", SizeSmooth::kOff}},
                                          "vote of the neighbours on where the size stops")),
      expert(number_option<O>(
          "evidence", &O::evidence, 0.0, 1e6,
          "standard deviations of a difference that no vote overrules; 0: any vote")),
      integer_option<O>("size_step", &O::step, 0, 16,
                        "levels that a size may lie above the least its neighbours chose; 0: any"),
      switch_option<O>("size_lone", &O::lone,
                       "a size that no line of pieces shares stays; else it is its neighbours'"),
  };
}

OptionTable<FilterWidthOptions> filter_width_option_table() {
  using O = FilterWidthOptions;
  return {
      choice_option<O, AnisotropySource>("anisotropy", &O::anisotropy,
                                         {{"bank", AnisotropySource::kFilterBank},
                                          {"none", AnisotropySource::kNone},
                                          {"structure_tensor", AnisotropySource::kStructureTensor}},
                                         "where directions come from"),
      expert(choice_option<O, FilterAngle>(
          "angle", &O::angle,
          {{"tangent", FilterAngle::kTangent}, {"normal", FilterAngle::kNormal}},
          "direction of a band: along its edges or across them")),
      number_option<O>("sigma_max", &O::sigma_max, 0.0, 16.0,
                       "widest standard deviation, in units of the size 2^k"),
      expert(number_option<O>("rho", &O::rho, 0.0, 1.0, "narrowest standard deviation / widest")),
      expert(
          number_option<O>("gamma_d", &O::gamma_d, 0.0, 16.0, "exponent of the relative energy")),
  };
}

OptionTable<FilterOptions> filter_option_table() {
  using O = FilterOptions;
  return {
      expert(choice_option<O, Eq12>(
          "eq12", &O::eq12, {{"corrected", Eq12::kCorrected}, {"literal", Eq12::kLiteral}},
          "interpolation of the width; literal has its weights exchanged")),
      expert(choice_option<O, FilterWindow>(
          "window", &O::window, {{"disc", FilterWindow::kDisc}, {"square", FilterWindow::kSquare}},
          "shape of the filter's region")),
      expert(choice_option<O, FilterWeighting>(
          "weighting", &O::weighting,
          {{"per_piece", FilterWeighting::kPerPiece}, {"per_sample", FilterWeighting::kPerSample}},
          "each piece counts alike, or each sample")),
      expert(choice_option<O, FilterGranularity>(
          "recon_granularity", &O::granularity,
          {{"piece", FilterGranularity::kPiece}, {"sample", FilterGranularity::kSample}},
          "distances to piece centres, or to film positions where they were recorded")),
  };
}

}  // namespace

DirectionalOptions robust_directional_options() {
  return {};
}

DirectionalOptions paper_directional_options() {
  DirectionalOptions options;
  options.normalise_exposure = false;
  options.var_mode = VarianceMode::kRaw;
  options.noise_pool = 0;
  options.base = BaseImage::kNone;
  options.pyramid.detail = LaplacianDetail::kPhase00;
  options.size.variance = SizeVariance::kContrast;
  options.size.contrast = ContrastForm::kLiteral;
  options.size.coarse = SizeCoarse::kPyramid;
  options.size.factor.rule = SizeFactorRule::kLiteral;
  options.size.factor_fallback = 0.0;
  options.size.track_a0 = true;
  options.size.smooth = SizeSmooth::kOff;
  options.size.evidence = 0.0;
  options.size.lone = true;
  options.bank.levels = 2;
  options.width.anisotropy = AnisotropySource::kFilterBank;
  options.energy.measure = DirectionMeasure::kAbs;
  options.energy.noise_correct = false;
  options.energy.stand_out = 0.0;
  options.energy.smoothing = 0.75;
  options.width.sigma_max = 0.50;
  options.width.rho = 0.15;
  options.width.gamma_d = 1.0;
  options.filter.window = FilterWindow::kSquare;
  options.filter.weighting = FilterWeighting::kPerSample;
  options.filter.granularity = FilterGranularity::kSample;
  options.scope = ReconstructionScope::kTile;
  options.precision = Precision::kFloat64;
  return options;
}

OptionTable<DirectionalOptions> directional_option_table() {
  using O = DirectionalOptions;
  OptionTable<O> table = {
      choice_option<O, Deciding>("decide", &O::decide,
                                 {{"own", Deciding::kOwn}, {"halves", Deciding::kHalves}},
                                 "all samples about all, or each half of them about the other"),
      expert(choice_option<O, bool>(
          "exposure", &O::normalise_exposure, {{"normalise", true}, {"none", false}},
          "bring the mean luminance to 1 before deciding where the sampler did not")),
      expert(var_mode_option(&O::var_mode)),
      integer_option<O>("noise_pool", &O::noise_pool, 0, 64,
                        "largest radius from which a variance is pooled, pieces; 0: not at all"),
      choice_option<O, BaseImage>(
          "base", &O::base,
          {{"chosen", BaseImage::kChosen},
           {"pixel_gaussian", BaseImage::kPixelGaussian},
           {"none", BaseImage::kNone}},
          "small filter that piece means pass first: where eq 9 says so, always, never"),
  };
  append_options(table, pyramid_option_table(), &O::pyramid);
  append_options(table, filter_size_option_table(), &O::size);
  append_options(table, bank_option_table(), &O::bank);
  append_options(table, energy_option_table(), &O::energy);
  append_options(table, filter_width_option_table(), &O::width);
  append_options(table, filter_option_table(), &O::filter);
  table.push_back(expert(choice_option<O, ReconstructionScope>(
      "recon_scope", &O::scope,
      {{"global", ReconstructionScope::kGlobal}, {"tile", ReconstructionScope::kTile}},
      "analyse and filter the whole image, or each tile alone")));
  table.push_back(
      expert(integer_option<O>("tile", &O::tile, 16, 1 << 20, "pieces per side of a tile")));
  table.push_back(expert(choice_option<O, Precision>(
      "recon_precision", &O::precision,
      {{"float32", Precision::kFloat32}, {"float64", Precision::kFloat64}},
      "precision of bands, energies and weights; sums are always float64")));
  return table;
}

std::vector<Reading> directional_readings() {
  return {
      {"one_phase", "eq 4", "detail of one of the four phases", {{"detail", "phase00"}}},
      {"all_phases", "eq 4", "detail averaged over the phases", {{"detail", "cycle_spun"}}},
      {"mean_contrast",
       "eq 9, S",
       "the printed word: contrast of eq 6",
       {{"size_variance", "contrast"}}},
      {"variance", "eq 9, S", "variance of the mean over R_k", {{"size_variance", "coarse_var"}}},
      {"pyramid_means", "eq 9, q", "f_k of the pyramid", {{"size_coarse", "pyramid"}}},
      {"region_means", "eq 9, q", "mean over R_k", {{"size_coarse", "box"}}},
      {"printed_factor",
       "eq 9, w",
       "|A_k - A_(k+1)| / (A_k + A_(k+1))",
       {{"size_factor", "literal"}}},
      {"reciprocal_factor", "eq 9, w", "its reciprocal", {{"size_factor", "inverse"}}},
      {"fixed_factor", "eq 9, w", "0.5, without A", {{"size_factor", "const(0.5)"}}},
      {"continuous_width", "eq 12", "weights that join at each direction", {{"eq12", "corrected"}}},
      {"printed_width", "eq 12", "the printed weights", {{"eq12", "literal"}}},
      {"tiled", "tiles", "each tile is filtered alone", {{"recon_scope", "tile"}}},
      {"untiled", "tiles", "the image is filtered whole", {{"recon_scope", "global"}}},
  };
}

}  // namespace spool
