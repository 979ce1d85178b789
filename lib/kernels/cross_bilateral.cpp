#include "lib/kernels/cross_bilateral.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/kernels/feature_guide.h"
#include "lib/kernels/guided_means.h"
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

// The scale of least risk, smoothed, and the means filtered with it: all scales of a tile are
// computed, one is kept.
void filter_with_least_risk(const FeatureGuide& guide, const RgbImage& mean,
                            const std::vector<Plane>& risk, const CrossBilateralOptions& options,
                            RisksKept kept, CrossBilateralImage& result) {
  const int width = guide.width, height = guide.height;
  const auto none = static_cast<std::size_t>(options.scales.front() == 0.0);
  std::vector<const Plane*> images;
  for (const Plane& plane : risk)
    images.push_back(&plane);
  for (const Plane& plane : mean)
    images.push_back(&plane);
  std::vector<GuidedTarget> targets = {{options.risk_scale, 0, risk.size()}};
  for (std::size_t s = none; s < risk.size(); ++s)
    targets.push_back({options.scales[s], risk.size(), 3});
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
                                            GuardCounts& guards, RisksKept kept) {
  if (pool.recording().features().empty()) {
    return fail(ErrorCode::kData,
                "{}: cross_bilateral needs albedo, normal or depth of each sample, which were not "
                "recorded: record them, or use a method without features",
                pool.recording().name());
  }
  const int width = statistics.width(), height = statistics.height();
  const auto none = static_cast<std::size_t>(options.scales.front() == 0.0);
  CrossBilateralImage result;
  std::vector<Plane> risk;
  FeatureGuide guide;
  {
    SPOOL_ASSIGN(const FilteredInput input, filter_input(statistics, exposure, guards));
    SPOOL_ASSIGN(guide, make_feature_guide(
                            pool, statistics.n,
                            [&](std::string_view layer) {
                              return layer == "normal"   ? options.sigma_normal
                                     : layer == "albedo" ? options.sigma_albedo
                                                         : options.sigma_depth;
                            },
                            guards));
    risk = estimate_risks(guide, input, options, none);
    result.variance = Plane(width, height);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < result.variance.size(); ++i)
        result.variance[i] += input.variance[c][i] / 3.0;
    }
  }

  filter_with_least_risk(guide, *FilledMeans(statistics), risk, options, kept, result);
  return result;
}

OptionTable<CrossBilateralOptions> cross_bilateral_option_table() {
  using O = CrossBilateralOptions;
  return {
      number_option<O>("sigma_normal", &O::sigma_normal, 1e-3, 1e3, "tolerance for normals"),
      number_option<O>("sigma_albedo", &O::sigma_albedo, 1e-3, 1e3, "tolerance for albedo"),
      number_option<O>("sigma_depth", &O::sigma_depth, 1e-3, 1e3,
                       "tolerance for depth, in units of the largest"),
  };
}

}  // namespace spool
