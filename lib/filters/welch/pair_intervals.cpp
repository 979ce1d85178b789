#include "lib/filters/welch/pair_intervals.h"

#include <cmath>
#include <utility>

#include "lib/kernels/denoised_variance.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/scene_luminance.h"

namespace spool {
namespace {

// Intervals are a little wider than the test says, so that equal pixels without variance pass.
constexpr double kWiderBy = 1e-6, kLeastHalf2 = 1e-12;

// Where no neighbour of an empty piece serves, its value stays.
RgbImage filtered_means(const RgbImage& image, const CountImage& n, const PairTest& test,
                        const PairFeatures& features, const PairWindow& window,
                        GuardCounts& guards) {
  const PairMeans means =
      pair_filter({&image[0], &image[1], &image[2]}, test, features, float_counts(n), window);
  RgbImage result = image;
  for (std::size_t i = 0; i < n.size(); ++i) {
    const bool none = !(means.weight[i] > 0.0);
    guards.add(Guard::kZeroWeight, none ? 1 : 0);
    for (std::size_t c = 0; c < 3 && !none; ++c)
      result[c][i] = means.value[c][i];
  }
  return result;
}

void add_footprints(const RgbImage& image, const PieceStatistics& statistics, const PairTest& test,
                    const PairFeatures& features, const PairWindow& window,
                    const FilterContext& context) {
  if (wanted_pixels(context).empty()) return;
  const Image<float> count = float_counts(statistics.n);
  const int q = statistics.pieces_per_side;
  for (const auto& [x, y] : wanted_pixels(context)) {
    Footprint footprint{x, y, {}, {}};
    for (int i = 0; i < q * q; ++i) {
      add_pair_footprint(image, test, features, count, window, x * q + i % q, y * q + i / q,
                         1.0 / (q * q), q, footprint);
    }
    context.footprints->add(std::move(footprint));
  }
}

}  // namespace

void add_test(PairTest& test, const RgbImage& mean, const RgbImage& variance, const Plane& samples,
              const IntervalRule& rule, const StudentTable& student) {
  for (std::size_t c = 0; c < 3; ++c) {
    Image<float> half2(samples.width(), samples.height());
    for (std::size_t i = 0; i < half2.size(); ++i) {
      const double n = samples[i];
      const double t = student(rule.centre_alone ? n - 1.0 : 2.0 * n - 2.0);
      half2[i] =
          static_cast<float>(rule.theta * t * t * variance[c][i] * (1.0 + kWiderBy) + kLeastHalf2);
    }
    test.mean.push_back(to_float(mean[c]));
    test.half2.push_back(std::move(half2));
  }
}

double test_unit(const PieceStatistics& statistics) {
  GuardCounts counted_by_the_caller;
  return std::ldexp(1.0, -std::ilogb(scene_luminance(statistics, counted_by_the_caller)));
}

Result<Reconstruction> reconstruct_by_test(
    const Selection& selection, const SamplePool& pool, const PairFeatureOptions& of_features,
    const PairWindow& window, const FilterContext& context,
    const std::function<PairTest(const PairFeatures&)>& test_of) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  const double exposure = analysis_exposure(statistics, result.guards);
  SPOOL_ASSIGN(const PieceEstimates pieces,
               estimate_pieces(statistics, {}, exposure, result.guards));
  SPOOL_ASSIGN(const PairFeatures features,
               pair_features(pool, statistics.n, of_features, result.guards));
  const PairTest test = test_of(features);
  RgbImage image = filtered_means(pieces.mean, statistics.n, test, features, window, result.guards);
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  add_footprints(pieces.mean, statistics, test, features, window, context);
  return result;
}

OptionTable<PairFeatureOptions> pair_feature_option_table() {
  using O = PairFeatureOptions;
  return {number_option("sigma_albedo", &O::sigma_albedo, 1e-3, 100.0, "scale of albedo"),
          number_option("sigma_normal", &O::sigma_normal, 1e-3, 100.0, "scale of normals"),
          switch_option("feature_noise", &O::noise, "distances of features less their noise")};
}

OptionTable<PairWindow> pair_window_option_table() {
  return {integer_option("radius", &PairWindow::radius, 1, 64, "of the window, pixels"),
          number_option("sigma", &PairWindow::sigma, 0.1, 1000.0, "of its Gaussian, pixels")};
}

}  // namespace spool
