#include "lib/pyramid/laplacian_pyramid.h"

#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

FilterPair pair_of(const PyramidOptions& options, int k) {
  return filter_pair_at(options.filter, options.roles, options.even_align, k);
}

// f_{k+1} on `box` [LiuZheng (1)-(3)]
void coarsen(const Plane& fine, const PyramidOptions& options, int k, const Rectangle& box,
             Plane& coarse) {
  const Taps h = pair_of(options, k).analysis;
  const int dilation = pyramid_dilation(options, k);
  if (options.sign == LaplacianSign::kLiteral) {
    apply_eqs_1_to_3_box(fine, h, dilation, options.sign, options.extension, box, coarse);
  } else {
    convolve_box(fine, h, dilation, options.extension, box, coarse);
  }
}

// target = base - prediction(coarse) on `box` [LiuZheng (4)]
void subtract_prediction(const Plane& base, const Plane& coarse, const PyramidOptions& options,
                         int k, const Rectangle& box, Plane& target) {
  const Taps g = pair_of(options, k).synthesis;
  const int dilation = pyramid_dilation(options, k);
  switch (options.detail) {
    case LaplacianDetail::kCycleSpun:
      subtract_convolved_box(base, coarse, scaled(g, 0.5), dilation, options.extension, box,
                             target);
      return;
    case LaplacianDetail::kPhase00:
      subtract_convolved_phase00_box(base, coarse, g, dilation, options.extension, box, target);
      return;
    case LaplacianDetail::kAtrousDiff:
      for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x)
          target(x, y) = base(x, y) - coarse(x, y);
      }
      return;
  }
}

double eqs_1_to_3_at(const Plane& in, const Taps& analysis, int dilation, LaplacianSign sign,
                     Extension extension, int x, int y) {
  const int direction = sign == LaplacianSign::kCorrected ? 1 : -1;
  // The index that f^{ij}(2 u - m) of eqs 1 and 2 reads for output coordinate x, where x is element
  // 2 u + i of polyphase component x mod D.
  const auto source = [&](int at, int m, int n) {
    const int component = at % dilation, element = at / dilation;
    const int i = element % 2, u = (element - i) / 2;
    return extend((2 * u - m + direction * i) * dilation + component, n, extension);
  };
  const int first = analysis.first;
  const int count = static_cast<int>(analysis.values.size());
  double sum = 0.0;
  for (int b = 0; b < count; ++b) {
    const int from_y = source(y, first + b, in.height());
    double row_sum = 0.0;
    for (int a = 0; a < count; ++a) {
      const double term = analysis.values[static_cast<std::size_t>(a)] *
                          in(source(x, first + a, in.width()), from_y);
      row_sum = a == 0 ? term : row_sum + term;
    }
    const double term = analysis.values[static_cast<std::size_t>(b)] * row_sum;
    sum = b == 0 ? term : sum + term;
  }
  return sum;
}

void check_options(const PyramidOptions& options) {
  SPOOL_CHECK_GE(options.levels, 0);
  SPOOL_CHECK_LE(options.levels, 8);
}

}  // namespace

int pyramid_dilation(const PyramidOptions& options, int k) {
  return options.iteration == LaplacianIteration::kAtrous ? 1 << k : 1;
}

void coarsen_box(const Plane& fine, const PyramidOptions& options, int k, const Rectangle& box,
                 Plane& coarse) {
  coarsen(fine, options, k, box, coarse);
}

void detail_box(const Plane& fine, const Plane& coarse, const PyramidOptions& options, int k,
                const Rectangle& box, Plane& detail) {
  subtract_prediction(fine, coarse, options, k, box, detail);
}

void visit_coarse_rows(const Plane& fine, const PyramidOptions& options, int k,
                       const Rectangle& box, const RowVisitor& visit) {
  const Taps h = pair_of(options, k).analysis;
  const int dilation = pyramid_dilation(options, k);
  if (options.sign == LaplacianSign::kCorrected)
    return visit_convolved_rows(fine, h, dilation, options.extension, box, visit);
  Plane row(fine.width(), 1);
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x)
      row(x, 0) = eqs_1_to_3_at(fine, h, dilation, options.sign, options.extension, x, y);
    visit(y, &row(box.x0, 0));
  }
}

void visit_prediction_rows(const Plane& coarse, const PyramidOptions& options, int k,
                           const Rectangle& box, const RowVisitor& visit) {
  const Taps g = pair_of(options, k).synthesis;
  const int dilation = pyramid_dilation(options, k);
  switch (options.detail) {
    case LaplacianDetail::kCycleSpun:
      return visit_convolved_rows(coarse, scaled(g, 0.5), dilation, options.extension, box, visit);
    case LaplacianDetail::kPhase00:
      return visit_convolved_phase00_rows(coarse, g, dilation, options.extension, box, visit);
    case LaplacianDetail::kAtrousDiff:
      for (int y = box.y0; y < box.y1; ++y)
        visit(y, &coarse(box.x0, y));
  }
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
    coarsen(pyramid.coarse[i], options, k, first.bounds(), pyramid.coarse[i + 1]);
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

void update_pyramid(Pyramid& pyramid, const Rectangle& changed, const PyramidOptions& options,
                    std::vector<Rectangle>* coarse_boxes, std::vector<Rectangle>* detail_boxes) {
  check_options(options);
  SPOOL_CHECK_EQ(pyramid.coarse.size(), static_cast<std::size_t>(options.levels) + 1);
  SPOOL_CHECK_EQ(pyramid.detail.size(), static_cast<std::size_t>(options.levels));
  std::vector<Rectangle> coarse, detail;
  pyramid_influence(changed, pyramid.coarse[0].bounds(), options, coarse, detail);
  for (int k = 0; k < options.levels; ++k) {
    const auto i = static_cast<std::size_t>(k);
    coarsen(pyramid.coarse[i], options, k, coarse[i + 1], pyramid.coarse[i + 1]);
    subtract_prediction(pyramid.coarse[i], pyramid.coarse[i + 1], options, k, detail[i],
                        pyramid.detail[i]);
  }
  if (coarse_boxes != nullptr) *coarse_boxes = std::move(coarse);
  if (detail_boxes != nullptr) *detail_boxes = std::move(detail);
}

void pyramid_influence(const Rectangle& changed, const Rectangle& bounds,
                       const PyramidOptions& options, std::vector<Rectangle>& coarse_boxes,
                       std::vector<Rectangle>& detail_boxes) {
  coarse_boxes.assign(1, intersect(changed, bounds));
  detail_boxes.clear();
  for (int k = 0; k < options.levels; ++k) {
    FilterPair pair = pair_of(options, k);
    // Eq 1 as printed reads up to two steps further back.
    if (options.sign == LaplacianSign::kLiteral)
      pair.analysis.values.resize(pair.analysis.values.size() + 2);
    const int dilation = pyramid_dilation(options, k);
    const Rectangle fine = coarse_boxes.back();
    const Rectangle coarse =
        convolution_influence(fine, pair.analysis, dilation, options.extension, bounds);
    const Rectangle predicted =
        options.detail == LaplacianDetail::kAtrousDiff
            ? coarse
            : convolution_influence(coarse, pair.synthesis, dilation, options.extension, bounds);
    coarse_boxes.push_back(coarse);
    detail_boxes.push_back(unite(fine, predicted));
  }
}

void apply_eqs_1_to_3_box(const Plane& in, const Taps& analysis, int dilation, LaplacianSign sign,
                          Extension extension, const Rectangle& box, Plane& out) {
  SPOOL_CHECK(in.same_size(out));
  parallel_rows(box.y0, box.y1, [&](int y) {
    for (int x = box.x0; x < box.x1; ++x)
      out(x, y) = eqs_1_to_3_at(in, analysis, dilation, sign, extension, x, y);
  });
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
      choice_option<O, FilterRoles>(
          "filter_roles", &O::roles,
          {{"long_analysis", FilterRoles::kLongAnalysis}, {"swapped", FilterRoles::kSwapped}},
          "which filter of the pair analyses"),
      choice_option<O, EvenAlign>(
          "even_align", &O::even_align,
          {{"alternate", EvenAlign::kAlternate}, {"causal", EvenAlign::kCausal}},
          "where even-length filters (haar, db3) are centred at odd levels"),
      choice_option<O, LaplacianIteration>(
          "lp_iteration", &O::iteration,
          {{"atrous", LaplacianIteration::kAtrous}, {"undilated", LaplacianIteration::kUndilated}},
          "dilation of the filter from level to level"),
      choice_option<O, LaplacianSign>(
          "lp_sign", &O::sign,
          {{"corrected", LaplacianSign::kCorrected}, {"literal", LaplacianSign::kLiteral}},
          "sign of eq 1; literal only shows the misprint"),
      choice_option<O, LaplacianDetail>("lp_detail", &O::detail,
                                        {{"cycle_spun", LaplacianDetail::kCycleSpun},
                                         {"phase00", LaplacianDetail::kPhase00},
                                         {"atrous_diff", LaplacianDetail::kAtrousDiff}},
                                        "detail image of eq 4"),
      integer_option<O>("K", &O::levels, 1, 6, "levels of the pyramid"),
  };
}

}  // namespace spool
