#include "lib/filters/welch/welch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/scene_luminance.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/student_table.h"
#include "lib/statistics/transformed_moments.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {
namespace {

constexpr PairWindow kPoolingWindow = {3, 1.0};
// Intervals are a little wider than the test says, so that equal pixels without variance pass.
constexpr double kWiderBy = 1e-6, kLeastHalf2 = 1e-12;
constexpr double kLeastVariance = 1.19e-7;  // below it no skewness is estimated [Sakai24]
constexpr double kSymmetric = 1e20;         // for kappa = infinity: 0 times it is still a number

Image<float> to_float(const Plane& plane, double factor = 1.0) {
  Image<float> image(plane.width(), plane.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    image[i] = static_cast<float>(factor * plane[i]);
  return image;
}

// Half of each variance is that of its 3 x 3 neighbourhood.
Plane smoothed(const Plane& variance) {
  Plane out(variance.width(), variance.height());
  const auto clamped = [&](int x, int y) {
    return variance(std::clamp(x, 0, variance.width() - 1),
                    std::clamp(y, 0, variance.height() - 1));
  };
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double sum = 0.0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u)
          sum += clamped(x + u, y + v);
      }
      out(x, y) = 0.5 * (variance(x, y) + sum / 9.0);
    }
  }
  return out;
}

Result<PairFeatures> pair_features(const SamplePool& pool, const CountImage& n,
                                   const WelchOptions& options, GuardCounts& guards) {
  PairFeatures features;
  for (const FeatureLayer& layer : pool.recording().features()) {
    if (layer.name != "albedo" && layer.name != "normal") continue;
    const double sigma = layer.name == "albedo" ? options.sigma_albedo : options.sigma_normal;
    const double scale = 1.0 / (sigma * std::sqrt(2.0));
    SPOOL_ASSIGN(const FeatureStatistics feature, feature_statistics(pool, n, layer, guards));
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      features.value.push_back(to_float(feature.mean[c], scale));
      features.variance.push_back(to_float(
          options.feature_noise ? smoothed(feature.variance[c]) : Plane(n.width(), n.height()),
          scale * scale));
    }
  }
  return features;
}

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

void add_test(PairTest& test, const RgbImage& mean, const RgbImage& variance, const Plane& samples,
              const WelchOptions& options, const StudentTable& student) {
  for (std::size_t c = 0; c < 3; ++c) {
    Image<float> half2(samples.width(), samples.height());
    for (std::size_t i = 0; i < half2.size(); ++i) {
      const double n = samples[i];
      const double t = student(options.kappa == 0.0 ? n - 1.0 : 2.0 * n - 2.0);
      half2[i] = static_cast<float>(options.theta * t * t * variance[c][i] * (1.0 + kWiderBy) +
                                    kLeastHalf2);
    }
    test.mean.push_back(to_float(mean[c]));
    test.half2.push_back(std::move(half2));
  }
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
             {std::move(v[k + 1]), std::move(v[k + 3]), std::move(v[k + 5])}, samples, options,
             student);
  }
}

PairTest pair_test(const Selection& selection, const SamplePool& pool, const PairFeatures& features,
                   double unit, const WelchOptions& options) {
  const CountImage& n = selection.statistics.n;
  std::vector<Estimates> all;
  for (const double lambda : options.lambda)
    all.push_back(estimates(pool, n, unit, lambda, options.johnson));
  Plane samples(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i)
    samples[i] = std::max(n[i], 1);  // an empty piece has its neighbours' values
  const StudentTable student(options.alpha);
  PairTest test;
  test.kappa = std::min(options.kappa, kSymmetric);
  if (options.pooled) {
    add_pooled_test(test, all, features, samples, options, student);
  } else {
    for (const Estimates& one : all)
      add_test(test, one.mean, one.variance, samples, options, student);
  }
  return test;
}

}  // namespace

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
    pooled.sigma_albedo = 0.08;
    pooled.sigma_normal = 0.4;
    pooled.feature_noise = true;
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
      switch_option("pooled", &O::pooled, "small neighbourhoods are tested, not pixels"),
      number_option("sigma_albedo", &O::sigma_albedo, 1e-3, 100.0, "scale of albedo"),
      number_option("sigma_normal", &O::sigma_normal, 1e-3, 100.0, "scale of normals"),
      switch_option("feature_noise", &O::feature_noise, "distances of features less their noise")};
  append_options<O, PairWindow>(
      table,
      {integer_option("radius", &PairWindow::radius, 1, 64, "of the window, pixels"),
       number_option("sigma", &PairWindow::sigma, 0.1, 1000.0, "of its Gaussian, pixels")},
      &O::window);
  return table;
}

Result<Reconstruction> reconstruct_welch(const Selection& selection, const SamplePool& pool,
                                         const WelchOptions& options, const FilterContext&) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  SPOOL_ASSIGN(const PieceEstimates pieces,
               estimate_pieces(statistics, {}, exposure, result.guards));
  SPOOL_ASSIGN(const PairFeatures features,
               pair_features(pool, statistics.n, options, result.guards));
  GuardCounts counted_above;
  const double unit = std::ldexp(1.0, -std::ilogb(scene_luminance(statistics, counted_above)));
  const PairTest test = pair_test(selection, pool, features, unit, options);
  Image<float> count(statistics.width(), statistics.height());
  for (std::size_t i = 0; i < count.size(); ++i)
    count[i] = static_cast<float>(statistics.n[i]);
  PairMeans means = pair_filter({&pieces.mean[0], &pieces.mean[1], &pieces.mean[2]}, test, features,
                                count, options.window);
  RgbImage image = pieces.mean;  // where no neighbour of an empty piece serves
  for (std::size_t i = 0; i < count.size(); ++i) {
    const bool none = !(means.weight[i] > 0.0);
    result.guards.add(Guard::kZeroWeight, none ? 1 : 0);
    for (std::size_t c = 0; c < 3 && !none; ++c)
      image[c][i] = means.value[c][i];
  }
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

Filter welch_filter() {
  return make_value<FilterFunction, WelchOptions>(
      {.name = "welch",
       .summary = "neighbours that a t-test of their samples cannot tell apart are averaged",
       .options = welch_option_table(),
       .presets = welch_presets(),
       .needs = [](const auto&) { return Needs{.features = Use::kWhenRecorded}; },
       .memory = {273, 5e6},
       .run = reconstruct_welch});
}

}  // namespace spool
