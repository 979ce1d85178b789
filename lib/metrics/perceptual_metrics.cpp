#include "lib/metrics/perceptual_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/metrics/flip.h"
#include "lib/metrics/structural_similarity.h"
#include "lib/metrics/tone_map.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Block sums and counts of a map's finite values; pixel (x, y) of the map lies at (x, y) * scale.
struct BlockMeans {
  std::vector<double> sum, count;

  BlockMeans(const Plane& map, int scale, const BlockBootstrap& bootstrap)
      : sum(static_cast<std::size_t>(bootstrap.blocks()), 0.0), count(sum) {
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        if (!std::isfinite(map(x, y))) continue;
        const auto block = static_cast<std::size_t>(bootstrap.block_of(x * scale, y * scale));
        sum[block] += map(x, y);
        count[block] += 1.0;
      }
    }
  }
  double mean(std::span<const double> weights) const {
    return quotient(weighted_sum(sum, weights), weighted_sum(count, weights));
  }
};

using Statistic = std::function<double(std::span<const double> weights)>;

// `scales`: what the statistic is made of.
PerceptualValue bootstrapped(std::string name, const BlockBootstrap& bootstrap,
                             std::span<const BlockMeans> scales, const Statistic& statistic) {
  PerceptualValue value{std::move(name), {}, {}};
  value.estimate.value = statistic({});
  const auto several = [](const BlockMeans& means) { return in_several_blocks(means.count); };
  if (!std::ranges::all_of(scales, several)) return value;
  for (int r = 0; r < bootstrap.resamples(); ++r)
    value.resampled.push_back(statistic(bootstrap.weights(r)));
  value.estimate.standard_error = standard_error_of(value.resampled);
  return value;
}

// Tone-mapped luma, NaN where not judged.
Plane luma(const ReferenceSide& side) {
  Plane result(side.judged.width(), side.judged.height(), kNaN);
  for (std::size_t p = 0; p < result.size(); ++p) {
    if (side.judged[p]) result[p] = luminance(side.tone[0][p], side.tone[1][p], side.tone[2][p]);
  }
  return result;
}

Plane only_judged(Plane map, const Image<std::uint8_t>& judged) {
  for (std::size_t p = 0; p < map.size(); ++p) {
    if (!judged[p]) map[p] = kNaN;
  }
  return map;
}

PerceptualValue ms_ssim(const std::vector<SimilarityMaps>& maps, const BlockBootstrap& bootstrap) {
  std::vector<BlockMeans> scales;
  for (std::size_t j = 0; j < maps.size(); ++j) {
    const bool last = j + 1 == maps.size();
    scales.emplace_back(last ? maps[j].ssim : maps[j].contrast_structure, 1 << j, bootstrap);
  }
  const std::vector<double> weights = ms_ssim_weights(static_cast<int>(maps.size()));
  return bootstrapped("ms_ssim", bootstrap, scales, [&](std::span<const double> blocks) {
    std::vector<double> means;
    for (const BlockMeans& scale : scales)
      means.push_back(scale.mean(blocks));
    return ms_ssim_value(means, weights);
  });
}

PerceptualValue map_mean(const char* name, const Plane& map, const BlockBootstrap& bootstrap) {
  const BlockMeans means(map, 1, bootstrap);
  return bootstrapped(name, bootstrap, std::span(&means, 1),
                      [&](std::span<const double> blocks) { return means.mean(blocks); });
}

}  // namespace

Plane flip_map(const RgbImage& estimate, const ReferenceSide& side) {
  Plane map =
      flip_difference(side.flip, flip_view(scaled_judged(estimate, side.exposure, side.judged)));
  for (std::size_t p = 0; p < map.size(); ++p) {
    if (!side.judged[p]) map[p] = 0.0;
  }
  return map;
}

PerceptualTable perceptual_metrics(const PerceptualInputs& inputs, const BlockBootstrap& bootstrap,
                                   Perceptual which, GuardCounts& guards,
                                   const std::function<bool(std::string_view)>& wanted) {
  PerceptualTable table{
      {{"ssim", {}, {}}, {"ms_ssim", {}, {}}, {"flip_ldr", {}, {}}, {"flip_hdr", {}, {}}}, {}};
  if (which == Perceptual::kNone) return table;
  const Image<std::uint8_t>& judged = inputs.side.judged;
  const int width = judged.width(), height = judged.height();
  if (wanted("ssim") || wanted("ms_ssim")) {
    if (ssim_window(width, height) < kSsimWindow || ms_ssim_scales(width, height) < 5)
      guards.add(Guard::kSmallImage);
    const std::vector<SimilarityMaps> maps =
        ms_ssim_maps(inputs.luma, luma(inputs.side), wanted("ms_ssim") ? 5 : 1);
    if (wanted("ssim")) table.values[0] = map_mean("ssim", maps.front().ssim, bootstrap);
    if (wanted("ms_ssim")) table.values[1] = ms_ssim(maps, bootstrap);
  }
  if (wanted("flip_ldr")) {
    table.flip = flip_map(inputs.estimate, inputs.side);
    table.values[2] = map_mean("flip_ldr", only_judged(table.flip, judged), bootstrap);
  }
  if (which != Perceptual::kAll || !wanted("flip_hdr")) return table;
  const auto hdr = flip_hdr_map(scaled_judged(inputs.reference, 1.0, judged),
                                scaled_judged(inputs.estimate, 1.0, judged), judged);
  if (hdr) table.values[3] = map_mean("flip_hdr", only_judged(*hdr, judged), bootstrap);
  return table;
}

}  // namespace spool
