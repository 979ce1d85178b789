#include "lib/kernels/cross_bilateral.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/kernels/feature_guide.h"
#include "lib/kernels/guided_means.h"
#include "lib/kernels/kernel_footprint.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/truncated_filter.h"

namespace spool {
namespace {

// What the risk is estimated from, exposed: the image and its variance after the small pixel
// filter.
struct FilteredInput {
  RgbImage image, variance;
};

Result<FilteredInput> filter_input(const PieceStatistics& statistics, double exposure,
                                   GuardCounts& guards) {
  const Taps taps = pixel_filter_taps();
  FilteredInput input;
  for (std::size_t c = 0; c < 3; ++c) {
    GuardCounts of_channel;
    SPOOL_ASSIGN(const ChannelEstimates pieces,
                 estimate_channel(statistics, c, {}, exposure, of_channel));
    if (c == 1) guards += of_channel;  // the channels share their empty pieces: count them once
    Plane &y = input.image[c], &v = input.variance[c];
    y = truncated_mean(pieces.mean, taps);
    v = truncated_variance(pieces.variance, taps, squared_taps(taps));
    for (std::size_t i = 0; i < y.size(); ++i) {
      y[i] *= exposure;
      v[i] *= exposure * exposure;
    }
  }
  return input;
}

// The means of the pieces, empty ones filled: the statistics' own where there is nothing to fill.
class FilledMeans {
 public:
  explicit FilledMeans(const PieceStatistics& statistics) : means_(statistics.mean) {
    if (std::find(statistics.n.pixels().begin(), statistics.n.pixels().end(), 0) ==
        statistics.n.pixels().end()) {
      return;
    }
    GuardCounts counted_elsewhere;
    filled_.emplace();
    for (std::size_t c = 0; c < 3; ++c) {
      (*filled_)[c] = fill_empty_pieces(statistics.mean[c], statistics.n,
                                        statistics.pieces_per_side, counted_elsewhere);
    }
  }
  const RgbImage& operator*() const { return filled_ ? *filled_ : means_; }

 private:
  const RgbImage& means_;
  std::optional<RgbImage> filled_;
};

// SURE of every scale. `none`: scales that leave the input as it is, 0 or 1.
std::vector<Plane> estimate_risks(const FeatureGuide& guide, const FilteredInput& input,
                                  const CrossBilateralOptions& options, std::size_t none) {
  const RgbImage &y = input.image, &v = input.variance;
  std::vector<Plane> risk(options.scales.size(), Plane(guide.width, guide.height));
  std::vector<GuidedTarget> targets;
  for (std::size_t s = none; s < options.scales.size(); ++s)
    targets.push_back({options.scales[s], 0, 3});
  const std::array<const Plane*, 3> images = {&y[0], &y[1], &y[2]};
  guided_means(guide, images, targets, [&](const Rectangle& tile, const auto& means) {
    for (std::size_t s = 0; s < risk.size(); ++s) {
      for (int py = tile.y0; py < tile.y1; ++py) {
        for (int px = tile.x0; px < tile.x1; ++px) {
          const int ix = px - tile.x0, iy = py - tile.y0;
          const double slope = s < none ? 1.0 : 1.0 / means[s - none].weight(ix, iy);
          double sum = 0.0;
          for (std::size_t c = 0; c < 3; ++c) {
            const double noise = v[c](px, py);
            const double f = s < none ? y[c](px, py) : means[s - none].values[c](ix, iy);
            const double d = f - y[c](px, py);
            sum += (d * d + 2.0 * noise * slope - noise) / 3.0;
          }
          risk[s](px, py) = sum;
        }
      }
    }
  });
  return risk;
}

// The risk of the input itself, and of each tolerance.
std::vector<Plane> estimate_patch_risks(const FeatureGuide& guide, const FilteredInput& input,
                                        const CrossPatchOptions& options) {
  std::vector<Plane> risk = cross_patch_risks(guide, input.image, input.variance, options);
  Plane own(guide.width, guide.height);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < own.size(); ++i)
      own[i] += input.variance[c][i] / 3.0;
  }
  risk.insert(risk.begin(), std::move(own));
  return risk;
}

// What there is to choose from: the risk of every candidate.
struct Candidates {
  std::vector<Plane> risk;
  std::vector<double> scales;  // of the last candidates, filtered while one is chosen
};

// The candidate of least risk, smoothed: all images of a tile are computed, one is kept. Candidates
// without a scale leave the means as they are.
void choose_least_risk(const FeatureGuide& guide, const RgbImage& mean,
                       const Candidates& candidates, double risk_scale, RisksKept kept,
                       CrossBilateralImage& result) {
  const int width = guide.width, height = guide.height;
  const std::vector<Plane>& risk = candidates.risk;
  const std::size_t none = risk.size() - candidates.scales.size();
  std::vector<const Plane*> images;
  for (const Plane& plane : risk)
    images.push_back(&plane);
  for (const Plane& plane : mean)
    images.push_back(&plane);
  std::vector<GuidedTarget> targets = {{risk_scale, 0, risk.size()}};
  for (const double scale : candidates.scales)
    targets.push_back({scale, risk.size(), 3});
  result.image = make_rgb(width, height);
  result.scale = CountImage(width, height);
  result.risk = Plane(width, height);
  if (kept == RisksKept::kAll) result.all.assign(risk.size(), Plane(width, height));
  guided_means(guide, images, targets, [&](const Rectangle& tile, const auto& means) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int ix = x - tile.x0, iy = y - tile.y0;
        const auto smooth = [&](std::size_t s) { return means[0].values[s](ix, iy); };
        std::size_t least = 0;
        for (std::size_t s = 1; s < risk.size(); ++s) {
          if (smooth(s) < smooth(least)) least = s;
        }
        result.risk(x, y) = smooth(least);
        result.scale(x, y) = static_cast<std::int32_t>(least);
        for (std::size_t c = 0; c < 3; ++c) {
          result.image[c](x, y) =
              least < none ? mean[c](x, y) : means[1 + least - none].values[c](ix, iy);
        }
        for (std::size_t s = 0; s < result.all.size(); ++s)
          result.all[s](x, y) = smooth(s);
      }
    }
  });
}

}  // namespace

Result<CrossBilateralImage> cross_bilateral(const PieceStatistics& statistics,
                                            const SamplePool& pool, double exposure,
                                            const CrossBilateralOptions& options,
                                            GuardCounts& guards, RisksKept kept,
                                            Footprints* footprints) {
  if (pool.recording().features().empty()) {
    return fail(ErrorCode::kData,
                "{}: cross_bilateral needs albedo, normal or depth of each sample, which were not "
                "recorded: record them, or use a method without features",
                pool.recording().name());
  }
  const int width = statistics.width(), height = statistics.height();
  const bool patches = options.range == CrossRange::kPatches;
  CrossBilateralImage result;
  const FilledMeans mean(statistics);
  Candidates candidates;
  FeatureGuide guide;
  RgbImage compared;  // whose patches are
  {
    SPOOL_ASSIGN(FilteredInput input, filter_input(statistics, exposure, guards));
    SPOOL_ASSIGN(guide, make_feature_guide(
                            pool, statistics.n,
                            [&](std::string_view layer) {
                              return layer == "normal"   ? options.sigma_normal
                                     : layer == "albedo" ? options.sigma_albedo
                                                         : options.sigma_depth;
                            },
                            guards));
    if (patches) {
      candidates.risk = estimate_patch_risks(guide, input, options.patches);
    } else {
      const auto none = static_cast<std::size_t>(options.scales.front() == 0.0);
      candidates.risk = estimate_risks(guide, input, options, none);
      candidates.scales.assign(options.scales.begin() + static_cast<std::ptrdiff_t>(none),
                               options.scales.end());
    }
    result.variance = Plane(width, height);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < result.variance.size(); ++i)
        result.variance[i] += input.variance[c][i] / 3.0;
    }
    if (patches) compared = std::move(input.image);
  }
  choose_least_risk(guide, *mean, candidates, options.risk_scale, kept, result);
  if (patches) {
    result.image = cross_patch_means(guide, compared, *mean, result.scale, options.patches);
  } else if (footprints) {
    for (const auto& [x, y] : footprints->wanted()) {
      footprints->add(guided_footprint(guide, *mean, result.scale, options.scales,
                                       statistics.pieces_per_side, x, y));
    }
  }
  return result;
}

OptionTable<CrossBilateralOptions> cross_bilateral_option_table() {
  using O = CrossBilateralOptions;
  return {
      choice_option<O, CrossRange>("range", &O::range,
                                   {{"none", CrossRange::kNone}, {"patches", CrossRange::kPatches}},
                                   "patches: cross non-local means instead of cross-bilateral"),
      number_option<O>("sigma_normal", &O::sigma_normal, 1e-3, 1e3, "tolerance for normals"),
      number_option<O>("sigma_albedo", &O::sigma_albedo, 1e-3, 1e3, "tolerance for albedo"),
      number_option<O>("sigma_depth", &O::sigma_depth, 1e-3, 1e3,
                       "tolerance for depth, in units of the largest"),
  };
}

}  // namespace spool
