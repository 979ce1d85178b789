#include "lib/filters/welch/welch.h"

#include <algorithm>
#include <utility>

#include "lib/core/student.h"
#include "lib/filters/welch/pair_intervals.h"
#include "lib/statistics/transformed_moments.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr PairWindow kPoolingWindow = {3, 1.0};
constexpr double kLeastVariance = 1.19e-7;  // below it no skewness is estimated [Sakai24]

// Means and variances of means of one transform, [channel]; empty pieces are filled.
struct Estimates {
  RgbImage mean, variance;
};

Estimates estimates(const SamplePool& pool, const CountImage& n, double unit, double lambda,
                    bool johnson) {
  TransformedMoments moments = transformed_moments(pool, n, unit, lambda);
  Estimates result;
  GuardCounts counted_on_the_whole;
  for (std::size_t c = 0; c < 3; ++c) {
    Plane& mean = moments.mean[c];
    Plane variance = variance_of_mean(n, mean, moments.m2[c], {}, counted_on_the_whole);
    for (std::size_t i = 0; johnson && i < mean.size(); ++i) {
      const double s2 = n[i] > 1 ? moments.m2[c][i] / (n[i] - 1) : 0.0;
      if (s2 > kLeastVariance) mean[i] += moments.m3[c][i] / n[i] / (6.0 * s2 * n[i]);
    }
    const auto filled = [&](Plane plane) {
      return fill_empty_pieces(std::move(plane), n, pool.pieces_per_side(), counted_on_the_whole);
    };
    result.mean[c] = filled(std::move(mean));
    result.variance[c] = filled(std::move(variance));
  }
  return result;
}

IntervalRule rule_of(const WelchOptions& options) {
  return {options.theta, options.kappa == 0.0};
}

// The same of small neighbourhoods, for all transforms at one go.
void add_pooled_test(PairTest& test, const std::vector<Estimates>& all,
                     const PairFeatures& features, const Plane& n, const WelchOptions& options,
                     const StudentTable& student) {
  std::vector<const Plane*> values;
  for (const Estimates& one : all) {
    for (std::size_t c = 0; c < 3; ++c) {
      values.push_back(&one.mean[c]);
      values.push_back(&one.variance[c]);
    }
  }
  const Image<float> ones(n.width(), n.height(), 1.0f);
  PairMeans pooled = pair_filter(values, {}, features, ones, kPoolingWindow);
  Plane samples = n;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double effective = pooled.weight[i] * pooled.weight[i] / pooled.weight2[i];
    samples[i] *= effective;
    for (std::size_t k = 1; k < pooled.value.size(); k += 2)
      pooled.value[k][i] /= effective;
  }
  for (std::size_t k = 0; k < pooled.value.size(); k += 6) {
    std::vector<Plane>& v = pooled.value;
    add_test(test, {std::move(v[k]), std::move(v[k + 2]), std::move(v[k + 4])},
             {std::move(v[k + 1]), std::move(v[k + 3]), std::move(v[k + 5])}, samples,
             rule_of(options), student);
  }
}

PairTest pair_test(const Selection& selection, const SamplePool& pool, const PairFeatures& features,
                   double unit, const WelchOptions& options) {
  const CountImage& n = selection.statistics.n;
  std::vector<Estimates> all;
  all.reserve(options.lambda.size());
  for (const double lambda : options.lambda)
    all.push_back(estimates(pool, n, unit, lambda, options.johnson));
  Plane samples(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i)
    samples[i] = std::max(n[i], 1);  // an empty piece has its neighbours' values
  const StudentTable student(options.alpha);
  PairTest test;
  test.kappa = std::min(options.kappa, kSymmetricTest);
  if (options.pooled) {
    add_pooled_test(test, all, features, samples, options, student);
  } else {
    for (const Estimates& one : all)
      add_test(test, one.mean, one.variance, samples, rule_of(options), student);
  }
  return test;
}

const Presets<WelchOptions>& welch_presets() {
  static const Presets<WelchOptions> presets = [] {
    WelchOptions moon, pooled;
    moon.lambda = {1.0};
    moon.alpha = 0.002;
    moon.kappa = 0.0;
    moon.johnson = false;
    pooled.lambda = {1.0, 0.25};
    pooled.theta = 0.5;
    pooled.kappa = 10.0;
    pooled.johnson = false;
    pooled.pooled = true;
    pooled.window = {10, 5.0};
    pooled.features = {0.08, 0.4, true};
    return Presets<WelchOptions>{{"statmc", {}}, {"moon", moon}, {"pooled", pooled}};
  }();
  return presets;
}

OptionTable<WelchOptions> welch_option_table() {
  using O = WelchOptions;
  OptionTable<O> table = {
      choice_option<O, std::vector<double>>(
          "lambda", &O::lambda,
          {{"1", {1.0}}, {"0.5", {0.5}}, {"0.25", {0.25}}, {"1+0.25", {1.0, 0.25}}},
          "transforms of the samples that are tested"),
      number_option("alpha", &O::alpha, 1e-6, 0.5, "level of the test"),
      number_option("theta", &O::theta, 0.0, 100.0, "factor on the squared half widths"),
      number_option("kappa", &O::kappa, 0.0, std::numeric_limits<double>::infinity(),
                    "how far the neighbour's error may excuse it, in units of the centre's"),
      switch_option("johnson", &O::johnson, "means are shifted for skewness"),
      switch_option("pooled", &O::pooled, "small neighbourhoods are tested, not pixels")};
  append_options(table, pair_feature_option_table(), &O::features);
  append_options(table, pair_window_option_table(), &O::window);
  return table;
}

// Error kData when no piece has a sample, or a feature cannot be read.
Result<Reconstruction> reconstruct_welch(const Selection& selection, const SamplePool& pool,
                                         const WelchOptions& options,
                                         const FilterContext& context) {
  const auto test_of = [&](const PairFeatures& features) {
    return pair_test(selection, pool, features, test_unit(selection.statistics), options);
  };
  return reconstruct_by_test(selection, pool, options.features, options.window, context, test_of);
}

}  // namespace

Filter welch_filter() {
  return make_value<FilterFunction, WelchOptions>(
      {.name = "welch",
       .summary = "neighbours that a t-test of their samples cannot separate are averaged",
       .options = welch_option_table(),
       .presets = welch_presets(),
       .needs = [](const auto&) { return Needs{.features = Use::kWhenRecorded}; },
       .memory = {273, 5e6},
       .cost = 2.2,
       .footprints = true,
       .run = reconstruct_welch});
}

}  // namespace spool
