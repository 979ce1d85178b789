#include "lib/reconstruction/nl_means.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/filters/piece_estimates.h"
#include "lib/statistics/variance_option.h"

namespace spool {
namespace {

struct Halves {
  PieceStatistics a, b;
};

Halves split_halves(const PieceStatistics& statistics, const SamplePool& pool) {
  const int width = statistics.width(), height = statistics.height();
  PieceStatistics empty;
  empty.pieces_per_side = statistics.pieces_per_side;
  empty.n = CountImage(width, height);
  empty.mean = make_rgb(width, height);
  empty.m2 = make_rgb(width, height);
  Halves halves{empty, empty};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t p = statistics.n.index(x, y);
      for (int s = 0; s < statistics.n[p]; ++s) {
        PieceStatistics& half = s % 2 == 0 ? halves.a : halves.b;
        const Rgb radiance = pool.sample(x, y, s);
        ++half.n[p];
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = static_cast<double>(radiance[c]);
          const double delta = value - half.mean[c][p];
          half.mean[c][p] += delta / half.n[p];
          half.m2[c][p] += delta * (value - half.mean[c][p]);
        }
      }
    }
  });
  return halves;
}

bool any_sample(const CountImage& n) {
  return std::any_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k > 0; });
}

Result<HalfImage> estimate_half(const PieceStatistics& half, const NlMeansOptions& options,
                                double exposure) {
  GuardCounts counted_as_a_whole;
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(half, {options.var_mode, options.nu0, options.key}, exposure,
                               counted_as_a_whole));
  HalfImage image{std::move(pieces.mean), std::move(pieces.variance)};
  for (std::size_t c = 0; c < 3; ++c) {
    for (double& v : image.mean[c].pixels())
      v *= exposure;
    for (double& v : image.variance[c].pixels())
      v *= exposure * exposure;
  }
  return image;
}

}  // namespace

OptionTable<NlMeansOptions> nl_means_option_table() {
  using O = NlMeansOptions;
  OptionTable<O> table;
  append_options(table, patch_filter_option_table(), &O::filter);
  table.push_back(var_mode_option(&O::var_mode));
  table.push_back(nu0_option(&O::nu0));
  table.push_back(number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the exposed luminance"));
  return table;
}

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const ReconstructionContext&,
                                            const NlMeansOptions& options) {
  const PieceStatistics& statistics = selection.statistics;
  Reconstruction result;
  if (!any_sample(statistics.n)) {
    return fail(ErrorCode::kData,
                "selection: no piece has a sample: raise the budget or check the counts");
  }
  for (const std::int32_t n : statistics.n.pixels())
    result.guards.add(Guard::kEmptyPiece, n == 0 ? 1 : 0);
  const double exposure = analysis_exposure(statistics, options.key, true, result.guards);
  Halves halves = split_halves(statistics, pool);
  if (!any_sample(halves.b.n)) halves.b = halves.a;  // one sample a piece: nothing to cross
  SPOOL_ASSIGN(const HalfImage a, estimate_half(halves.a, options, exposure));
  SPOOL_ASSIGN(const HalfImage b, estimate_half(halves.b, options, exposure));
  const RgbImage filtered_a = filter_with_guide(a.mean, b, options.filter);
  const RgbImage filtered_b = filter_with_guide(b.mean, a, options.filter);
  RgbImage image = filtered_a;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i) {
      const double na = std::max(1, halves.a.n[i]), nb = halves.b.n[i];
      image[c][i] = (na * filtered_a[c][i] + nb * filtered_b[c][i]) / (na + nb) / exposure;
    }
  }
  result.image = average_pieces(std::move(image), statistics.pieces_per_side);
  return result;
}

ReconstructorMethod<NlMeansOptions> nl_means_method() {
  return {"nl_means",
          "patches that look alike are averaged, weights from the other half of the samples",
          false,
          nl_means_option_table(),
          {{"", {}}},
          reconstruct_nl_means};
}

}  // namespace spool
