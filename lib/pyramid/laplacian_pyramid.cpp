#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {
namespace {

FilterPair pair_of(const PyramidOptions& options, int k) {
  return filter_pair_at(options.filter, options.roles, k);
}

// target = base - prediction(coarse) on `box` [LiuZheng (4)]
void subtract_prediction(const Plane& base, const Plane& coarse, const PyramidOptions& options,
                         int k, const Rectangle& box, Plane& target) {
  const Taps taps = prediction_taps(options, k);
  const int dilation = pyramid_dilation(k);
  switch (options.detail) {
    case LaplacianDetail::kCycleSpun:
      return subtract_convolved_box(base, coarse, taps, dilation, options.extension, box, target);
    case LaplacianDetail::kPhase00:
      return subtract_convolved_phase00_box(base, coarse, taps, dilation, options.extension, box,
                                            target);
  }
}

void check_options(const PyramidOptions& options) {
  SPOOL_CHECK_GE(options.levels, 0);
  SPOOL_CHECK_LE(options.levels, 8);
}

// f_{k+1} from f_k on `box` [LiuZheng (1)-(3)]. The output has the size of the input.
void coarsen_box(const Plane& fine, const PyramidOptions& options, int k, const Rectangle& box,
                 Plane& coarse) {
  convolve_box(fine, pair_of(options, k).analysis, pyramid_dilation(k), options.extension, box,
               coarse);
}

}  // namespace

int pyramid_dilation(int k) {
  return 1 << k;
}

Taps analysis_taps(const PyramidOptions& options, int k) {
  return pair_of(options, k).analysis;
}

Taps prediction_taps(const PyramidOptions& options, int k) {
  const Taps g = pair_of(options, k).synthesis;
  return options.detail == LaplacianDetail::kCycleSpun ? scaled(g, 0.5) : g;
}

Pyramid build_pyramid(const Plane& f0, const PyramidOptions& options) {
  Pyramid pyramid;
  rebuild_pyramid(pyramid, f0, options);
  return pyramid;
}

void rebuild_pyramid(Pyramid& pyramid, const Plane& f0, const PyramidOptions& options) {
  check_options(options);
  const auto levels = static_cast<std::size_t>(options.levels);
  if (pyramid.coarse.empty() || &f0 != &pyramid.coarse[0]) {
    pyramid.coarse.resize(levels + 1);
    pyramid.coarse[0] = f0;
  } else {
    pyramid.coarse.resize(levels + 1);
  }
  pyramid.detail.resize(levels);
  const Plane& first = pyramid.coarse[0];
  const auto fit = [&](Plane& plane) {
    if (!plane.same_size(first)) plane = Plane(first.width(), first.height());
  };
  for (std::size_t k = 0; k < levels; ++k) {
    fit(pyramid.coarse[k + 1]);
    fit(pyramid.detail[k]);
  }
  for (int k = 0; k < options.levels; ++k) {
    const auto i = static_cast<std::size_t>(k);
    coarsen_box(pyramid.coarse[i], options, k, first.bounds(), pyramid.coarse[i + 1]);
    subtract_prediction(pyramid.coarse[i], pyramid.coarse[i + 1], options, k, first.bounds(),
                        pyramid.detail[i]);
  }
}

Plane collapse(const Pyramid& pyramid, const PyramidOptions& options) {
  check_options(options);
  SPOOL_CHECK_EQ(pyramid.coarse.size(), static_cast<std::size_t>(options.levels) + 1);
  SPOOL_CHECK_EQ(pyramid.detail.size(), static_cast<std::size_t>(options.levels));
  Plane result = pyramid.coarse.back();
  const Plane zero(result.width(), result.height());
  Plane negative_prediction(result.width(), result.height());
  for (int k = options.levels - 1; k >= 0; --k) {
    const Plane& detail = pyramid.detail[static_cast<std::size_t>(k)];
    subtract_prediction(zero, result, options, k, result.bounds(), negative_prediction);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = detail[i] - negative_prediction[i];
  }
  return result;
}

void update_pyramid(Pyramid& pyramid, const Rectangle& changed, const PyramidOptions& options) {
  check_options(options);
  SPOOL_CHECK_EQ(pyramid.coarse.size(), static_cast<std::size_t>(options.levels) + 1);
  SPOOL_CHECK_EQ(pyramid.detail.size(), static_cast<std::size_t>(options.levels));
  std::vector<Rectangle> coarse, detail;
  pyramid_influence(changed, pyramid.coarse[0].bounds(), options, coarse, detail);
  for (int k = 0; k < options.levels; ++k) {
    const auto i = static_cast<std::size_t>(k);
    coarsen_box(pyramid.coarse[i], options, k, coarse[i + 1], pyramid.coarse[i + 1]);
    subtract_prediction(pyramid.coarse[i], pyramid.coarse[i + 1], options, k, detail[i],
                        pyramid.detail[i]);
  }
}

void pyramid_influence(const Rectangle& changed, const Rectangle& bounds,
                       const PyramidOptions& options, std::vector<Rectangle>& coarse_boxes,
                       std::vector<Rectangle>& detail_boxes) {
  coarse_boxes.assign(1, intersect(changed, bounds));
  detail_boxes.clear();
  for (int k = 0; k < options.levels; ++k) {
    const FilterPair pair = pair_of(options, k);
    const int dilation = pyramid_dilation(k);
    const Rectangle fine = coarse_boxes.back();
    const Rectangle coarse =
        convolution_influence(fine, pair.analysis, dilation, options.extension, bounds);
    const Rectangle predicted =
        convolution_influence(coarse, pair.synthesis, dilation, options.extension, bounds);
    coarse_boxes.push_back(coarse);
    detail_boxes.push_back(unite(fine, predicted));
  }
}

OptionTable<PyramidOptions> pyramid_option_table() {
  using O = PyramidOptions;
  return {
      choice_option<O, WaveletFilter>("filter", &O::filter,
                                      {{"5-3", WaveletFilter::k53},
                                       {"haar", WaveletFilter::kHaar},
                                       {"9-7", WaveletFilter::k97},
                                       {"db3", WaveletFilter::kDb3}},
                                      "wavelet of the pyramid"),
      expert(choice_option<O, FilterRoles>(
          "filter_roles", &O::roles,
          {{"long_analysis", FilterRoles::kLongAnalysis}, {"swapped", FilterRoles::kSwapped}},
          "which filter of the pair analyses")),
      expert(choice_option<O, LaplacianDetail>(
          "detail", &O::detail,
          {{"cycle_spun", LaplacianDetail::kCycleSpun}, {"phase00", LaplacianDetail::kPhase00}},
          "detail image of eq 4")),
      integer_option<O>("levels", &O::levels, 1, 6, "levels of the pyramid: K"),
  };
}

}  // namespace spool
