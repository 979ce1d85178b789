#include "lib/filters/welch/stater.h"

#include <algorithm>
#include <utility>

#include "lib/core/student.h"
#include "lib/filters/welch/pair_intervals.h"
#include "lib/kernels/denoised_variance.h"
#include "lib/statistics/transformed_moments.h"

namespace spool {
namespace {

// Means and variances of the samples of one transform; empty pieces are filled.
struct Transformed {
  RgbImage mean, variance;
};

Transformed transformed(const SamplePool& pool, const CountImage& n, double unit, double lambda,
                        const PairFeatures& features, const StaterOptions& options) {
  TransformedMoments moments = transformed_moments(pool, n, unit, lambda, HighestMoment::kFourth);
  SampleVariances variances = sample_variances(moments, n, pool.pieces_per_side());
  if (options.slope && pool.recording().has_film()) {
    correct_for_slope(variances, film_covariance(pool, n, unit, lambda, moments.mean), n);
  }
  Transformed result;
  GuardCounts counted_on_the_whole;
  for (std::size_t c = 0; c < 3; ++c) {
    result.mean[c] = fill_empty_pieces(std::move(moments.mean[c]), n, pool.pieces_per_side(),
                                       counted_on_the_whole);
  }
  result.variance = options.cascade
                        ? denoised_variance(variances, features, float_counts(n), options.window)
                        : std::move(variances.value);
  return result;
}

PairTest pair_test(const PieceStatistics& statistics, const SamplePool& pool,
                   const PairFeatures& features, const StaterOptions& options) {
  const CountImage& n = statistics.n;
  const double unit = test_unit(statistics);
  Plane samples(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i)
    samples[i] = std::max(n[i], 1);  // an empty piece has its neighbours' values
  const StudentTable student(options.alpha);
  PairTest test;
  test.kappa = kSymmetricTest;
  for (const double lambda : options.lambda) {
    Transformed one = transformed(pool, n, unit, lambda, features, options);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < n.size(); ++i)
        one.variance[c][i] /= samples[i];
    }
    add_test(test, one.mean, one.variance, samples, {}, student);
  }
  return test;
}

const Presets<StaterOptions>& stater_presets() {
  static const Presets<StaterOptions> presets = [] {
    StaterOptions mc, m;
    mc.slope = m.slope = m.cascade = false;
    return Presets<StaterOptions>{{"mcl", {}}, {"mc", mc}, {"m", m}};
  }();
  return presets;
}

OptionTable<StaterOptions> stater_option_table() {
  using O = StaterOptions;
  OptionTable<O> table = {
      choice_option<O, std::vector<double>>(
          "lambda", &O::lambda,
          {{"0.25+1", {0.25, 1.0}},
           {"0.5", {0.5}},
           {"0.5+0.75", {0.5, 0.75}},
           {"0.25+0.5+0.75+1", {0.25, 0.5, 0.75, 1.0}},
           {"0.01+0.25+0.5+0.75+1+3", {0.01, 0.25, 0.5, 0.75, 1.0, 3.0}}},
          "transforms of the samples that are tested"),
      number_option("alpha", &O::alpha, 1e-6, 0.5, "level of the test of means"),
      switch_option("cascade", &O::cascade, "variances are denoised first"),
      switch_option("slope", &O::slope, "variances without what a plane in the pixel explains")};
  append_options(table, pair_feature_option_table(), &O::features);
  append_options(table, pair_window_option_table(), &O::window);
  return table;
}

// Error kData when no piece has a sample, or a feature cannot be read.
Result<Reconstruction> reconstruct_stater(const Selection& selection, const SamplePool& pool,
                                          const StaterOptions& options,
                                          const FilterContext& context) {
  const auto test_of = [&](const PairFeatures& features) {
    return pair_test(selection.statistics, pool, features, options);
  };
  Result<Reconstruction> result =
      reconstruct_by_test(selection, pool, options.features, options.window, context, test_of);
  if (result && options.slope && !pool.recording().has_film()) {
    result->notes.emplace_back(
        "stater: film positions were not recorded, so variances keep what a slope adds to them");
  }
  return result;
}

}  // namespace

Filter stater_filter() {
  return make_value<FilterFunction, StaterOptions>(
      {.name = "stater",
       .summary = "neighbours that t-tests in two transforms cannot separate are averaged, by "
                  "denoised variances",
       .source = Source::kDescriptions,
       .options = stater_option_table(),
       .presets = stater_presets(),
       .needs =
           [](const StaterOptions& options) {
             return Needs{.features = Use::kWhenRecorded,
                          .film_positions = options.slope ? Use::kWhenRecorded : Use::kNone};
           },
       .memory = {478, 5e6},
       .cost = 7.6,
       .footprints = true,
       .run = reconstruct_stater});
}

}  // namespace spool
