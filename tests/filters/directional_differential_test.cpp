// The stages of the directional reconstruction against their slow twins, over small sizes.
#include <gtest/gtest.h>

#include "lib/filters/directional/base_image.h"
#include "lib/filters/directional/base_step.h"
#include "lib/filters/directional/directional.h"
#include "lib/filters/directional/sample_filter.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "tests/filters/directional_cases.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/anisotropic_filter_reference.h"
#include "tests/reference/directional_halves_reference.h"
#include "tests/reference/filter_size_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using testing::filter_pieces;
using testing::random_filter_case;
using testing::random_size_case;
using testing::random_widths;

std::vector<std::pair<int, int>> all_sizes() {
  std::vector<std::pair<int, int>> sizes;
  for (int i = 1; i <= 17; ++i) {
    sizes.emplace_back(i, 18 - i);
    sizes.emplace_back(i, i);
  }
  sizes.insert(sizes.end(), {{31, 5}, {5, 31}, {31, 31}, {64, 33}});
  return sizes;
}

void expect_same_sizes(const FilterSizeOptions& options, const char* what) {
  for (const auto& [width, height] : all_sizes()) {
    const auto c = random_size_case(width, height, 100);
    const auto expected = reference::filter_size(c.input(), options);
    GuardCounts guards;
    Views views({"T"});
    const CountImage level = filter_size(c.input(), options, &views, guards);
    std::vector<double> rounding;  // a factor of 1e6 makes T as large
    for (int k = 0; k < c.levels; ++k) {
      const Plane& t = expected.t[static_cast<std::size_t>(k)];
      rounding.push_back(1e-13 * std::max(1.0, reference::max_abs(t)));
      ASSERT_LT(reference::max_difference(views.collected()[static_cast<std::size_t>(k)].image, t),
                rounding.back())
          << what << " T." << k << " " << width << "x" << height;
    }
    // A decision may differ only where the criterion is lost in rounding.
    std::size_t undecided = 0;
    for (std::size_t i = 0; i < level.size(); ++i) {
      bool decided = true;
      for (std::size_t k = 0; k < rounding.size(); ++k) {
        if (std::abs(expected.t[k][i]) < rounding[k]) decided = false;
        if (std::abs(expected.vote[k][i] - (0.5 - 1e-9)) < 1e-13) decided = false;
        if (options.evidence > 0.0 && std::abs(expected.beyond[k][i]) < 1e-13) decided = false;
      }
      if (decided) {
        ASSERT_EQ(level[i], expected.level[i]) << what << " " << width << "x" << height;
      } else {
        ++undecided;
      }
    }
    // (In a small image the two largest regions are the same one: T = 0.)
    if (options.variance == SizeVariance::kCoarseVariance && std::min(width, height) > 16) {
      ASSERT_LT(undecided, level.size() / 4) << what << " " << width << "x" << height;
    }
  }
}

TEST(FilterSizeDifferential, RobustDefaultsAgree) {
  expect_same_sizes({}, "robust");
}

TEST(FilterSizeDifferential, EvidenceAgrees) {
  FilterSizeOptions options;
  for (const double evidence : {0.0, 0.5, 1.5}) {
    options.evidence = evidence;
    expect_same_sizes(options, "evidence");
  }
}

TEST(FilterSizeDifferential, TheStepToTheBaseImageAgrees) {
  for (const auto& [width, height] : all_sizes()) {
    const auto c = random_size_case(width, height, 100);
    for (const double evidence : {0.0, 1.0, 6.0}) {
      DirectionalOptions options;
      options.size.evidence = evidence;
      Plane t;
      const Plane expected = reference::refused_base(
          c.mean, c.variance, base_taps(options.base).values, options.size, &t);
      Tile tile;
      tile.pieces.n = tile.n = c.n;
      tile.pieces.mean = {c.mean, c.mean, c.mean};
      tile.pieces.variance = {c.variance, c.variance, c.variance};
      tile.analysis.mean = c.mean;
      tile.analysis.variance = c.variance;
      GuardCounts guards;
      Views views({"T"});
      const Plane refused = apply_base(options, tile, &views, guards);
      ASSERT_LT(reference::max_difference(views.collected()[0].image, t), 1e-14);
      EXPECT_EQ(refused, expected) << width << "x" << height;
      for (std::size_t i = 0; i < refused.size(); ++i) {
        if (refused[i] > 0.0) {
          ASSERT_EQ(tile.pieces.mean[1][i], c.mean[i]);
          ASSERT_EQ(tile.analysis.variance[i], c.variance[i]);
        }
      }
      const Plane all = convolve(c.mean, base_taps(BaseImage::kPixelGaussian));
      for (std::size_t i = 0; i < refused.size(); ++i) {
        if (refused[i] == 0.0) {
          ASSERT_EQ(tile.pieces.mean[2][i], all[i]);
        }
      }
    }
  }
}

TEST(FilterSizeDifferential, EveryFactorAgrees) {
  for (const auto rule : {SizeFactorRule::kLiteral, SizeFactorRule::kLiteralClamped,
                          SizeFactorRule::kInverse, SizeFactorRule::kGreedy}) {
    FilterSizeOptions options;
    options.factor.rule = rule;
    options.track_a0 = rule == SizeFactorRule::kLiteral;
    expect_same_sizes(options, "factor");
  }
}

TEST(FilterSizeDifferential, ContrastAndPyramidFormsAgree) {
  FilterSizeOptions options;
  options.variance = SizeVariance::kContrast;
  options.coarse = SizeCoarse::kPyramid;
  options.smooth = SizeSmooth::kOff;
  expect_same_sizes(options, "contrast");
  options.contrast = ContrastForm::kLiteral;
  options.smooth = SizeSmooth::kOn;
  expect_same_sizes(options, "literal contrast");
}

TEST(FilterSizeDifferential, SeveralSignalsDecideByTheMeanOfTheirCriteria) {
  for (const auto& [width, height] : {std::pair{7, 11}, {31, 18}}) {
    const std::vector<testing::SizeCase> cases = {random_size_case(width, height, 1),
                                                  random_size_case(width, height, 2),
                                                  random_size_case(width, height, 3)};
    FilterSizeOptions options;
    options.evidence = 0.0;
    options.smooth = SizeSmooth::kOff;
    std::vector<FilterSizeInput> inputs;
    std::vector<reference::FilterSizes> twins;
    for (const auto& c : cases) {
      inputs.push_back(c.input());
      twins.push_back(reference::filter_size(c.input(), options));
    }
    GuardCounts guards;
    Views views({"T"});
    const CountImage level = filter_size(inputs, options, &views, guards);
    for (std::size_t i = 0; i < level.size(); ++i) {
      int expected = 4;
      for (int k = 3; k >= 0; --k) {
        const auto at = static_cast<std::size_t>(k);
        const double t = (twins[0].t[at][i] + twins[1].t[at][i] + twins[2].t[at][i]) / 3.0;
        ASSERT_NEAR(views.collected()[at].image[i], t, 1e-13);
        if (t > 1e-13) expected = k;
      }
      ASSERT_EQ(level[i], expected) << width << "x" << height << " " << i;
    }
  }
}

template <class T>
void expect_same_filter(double bound) {
  for (const auto& [width, height] : all_sizes()) {
    const auto c = random_filter_case(width, height, 7);
    for (const int bank_levels : {1, 3}) {
      const auto widths = random_widths<T>(c.level, bank_levels, 8);
      for (const auto window : {FilterWindow::kDisc, FilterWindow::kSquare}) {
        for (const auto weighting : {FilterWeighting::kPerPiece, FilterWeighting::kPerSample}) {
          FilterOptions options;
          options.window = window;
          options.weighting = weighting;
          options.eq12 = bank_levels == 1 ? Eq12::kLiteral : Eq12::kCorrected;
          GuardCounts guards;
          const auto out = filter_pieces(c.input(), widths, options, guards);
          const auto expected = reference::filter_pieces(c.input(), widths, options);
          for (std::size_t channel = 0; channel < 3; ++channel) {
            ASSERT_LT(reference::max_difference(out.image[channel], expected.image[channel]), bound)
                << width << "x" << height;
            ASSERT_LT(reference::max_difference(out.variance[channel], expected.variance[channel]),
                      bound)
                << width << "x" << height;
          }
        }
      }
    }
  }
}

// Means lie in [0, 1].
TEST(AnisotropicFilterDifferential, DoubleWeightsAgreeTo2em14) {
  expect_same_filter<double>(2e-14);
}
TEST(AnisotropicFilterDifferential, FloatWeightsAgreeTo2em6) {
  expect_same_filter<float>(2e-6);
}

TEST(AnisotropicFilterDifferential, SingleSamplesAgree) {
  for (const int q : {1, 2}) {
    const int width = 9, height = 7;
    std::vector<FilmPosition> film;
    for (int s = 0; s < 12; ++s) {
      film.push_back({static_cast<float>(testing::random_unit(1, 1, static_cast<std::size_t>(s))),
                      static_cast<float>(testing::random_unit(1, 2, static_cast<std::size_t>(s)))});
    }
    const SamplePool pool = testing::make_pool(width, height, 12, testing::noisy_picture(9, 7, 3),
                                               {.pieces_per_side = q}, film);
    auto c = random_filter_case(pool.width(), pool.height(), 9, 3);
    for (int y = 0; y < pool.height(); ++y) {
      for (int x = 0; x < pool.width(); ++x)
        c.n(x, y) = std::min(c.n(x, y), pool.capacity(x, y));
    }
    const auto widths = random_widths<double>(c.level, 2, 10);
    for (const auto weighting : {FilterWeighting::kPerPiece, FilterWeighting::kPerSample}) {
      FilterOptions options;
      options.weighting = weighting;
      GuardCounts guards;
      const auto out = filter_samples(c.input(), widths, pool, 0, 0, options, guards);
      const auto expected = reference::filter_samples(c.input(), widths, pool, options);
      for (std::size_t channel = 0; channel < 3; ++channel)
        EXPECT_LT(reference::max_difference(out.image[channel], expected[channel]), 1e-13);
    }
  }
}

TEST(FilterWidthDifferential, WidthsAgreeWithBandsOfTheDefiningSums) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {2, 3}, {7, 5}, {16, 16}, {17, 31}}) {
    const Plane mean = reference::noise_image(width, height, 21);
    const Plane variance(width, height, 0.05);
    CountImage level(width, height);
    for (std::size_t i = 0; i < level.size(); ++i)
      level[i] = static_cast<int>(5 * testing::random_unit(5, 5, i));
    for (const int bank_levels : {2, 3}) {
      DirectionalOptions options;
      options.width.anisotropy = AnisotropySource::kFilterBank;
      options.bank.levels = bank_levels;
      const Pyramid pyramid = build_pyramid(mean, options.pyramid);
      const auto expected = reference::filter_widths(pyramid, variance, level, options);
      GuardCounts guards;
      const auto doubles =
          filter_widths<double>(pyramid, variance, level, options, nullptr, guards);
      const auto floats = filter_widths<float>(pyramid, variance, level, options, nullptr, guards);
      ASSERT_EQ(doubles.beta, expected.beta);
      for (std::size_t i = 0; i < expected.delta.size(); ++i) {
        EXPECT_LT(reference::max_difference(doubles.delta[i], expected.delta[i]), 1e-11);
        EXPECT_LT(reference::max_difference(floats.delta[i], expected.delta[i]), 2e-3);
      }
      for (std::size_t i = 0; i < level.size(); ++i) {
        // On a grid of one row two bands can have the same energy: either may be named.
        ASSERT_EQ(std::isnan(doubles.dominant[i]), std::isnan(expected.dominant[i]));
        if (std::isnan(doubles.dominant[i])) continue;
        double named = 0.0, widest = 0.0;
        for (std::size_t b = 0; b < expected.beta.size(); ++b) {
          widest = std::max(widest, expected.delta[b][i]);
          if (expected.beta[b] == doubles.dominant[i]) named = expected.delta[b][i];
        }
        EXPECT_NEAR(named, widest, 1e-11);
      }
    }
  }
}

TEST(DirectionalHalves, EachHalfIsFilteredBySizesOfTheOtherAsTheTwinSays) {
  DirectionalOptions options;
  options.decide = Deciding::kHalves;
  options.var_mode = VarianceMode::kRaw;
  options.noise_pool = 0;
  options.base = BaseImage::kNone;
  options.width.anisotropy = AnisotropySource::kNone;
  options.precision = Precision::kFloat64;
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 11}, {31, 18}, {40, 33}}) {
    const SamplePool pool =
        testing::make_pool(width, height, 9, testing::noisy_picture(width, height, 4));
    const Selection selection =
        testing::select_counts(pool, [](int x, int y) { return 4 + (x * 7 + y * 3) % 6; });
    const auto found = reconstruct_directional(selection, pool, options, {});
    const FilteredPieces expected =
        reference::directional_halves(pool, selection.statistics.n, options);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LT(reference::max_difference(found->image[c], expected.image[c]), 1e-13);
      EXPECT_LT(reference::max_difference((*found->variance)[c], expected.variance[c]), 1e-13);
    }
  }
}

}  // namespace
}  // namespace spool
