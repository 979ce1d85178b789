#include "lib/metrics/reference_side.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/metrics/metric_list.h"
#include "lib/metrics/tone_map.h"

namespace spool {
namespace {

RgbImage tone_mapped_image(const RgbImage& image, double exposure,
                           const Image<std::uint8_t>& judged) {
  RgbImage result = make_rgb(judged.width(), judged.height());
  parallel_rows(0, judged.height(), [&](int y) {
    for (int x = 0; x < judged.width(); ++x) {
      const std::size_t p = judged.index(x, y);
      for (std::size_t c = 0; judged[p] && c < 3; ++c)
        result[c][p] = tone_mapped(image[c][p], exposure);
    }
  });
  return result;
}

Image<std::uint8_t> deciles_of(const RgbImage& image, const Image<std::uint8_t>& judged) {
  Image<std::uint8_t> decile(judged.width(), judged.height());
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t p = 0; p < judged.size(); ++p) {
    if (judged[p]) order.emplace_back(luminance(image[0][p], image[1][p], image[2][p]), p);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    decile[order[i].second] = static_cast<std::uint8_t>(kDeciles * i / order.size());
  return decile;
}

bool has(const ReferenceSide& side, SideParts parts) {
  return (!parts.tone || side.tone[0].size() > 0) && (!parts.flip || side.flip.edge.size() > 0) &&
         (!parts.deciles || side.decile.size() > 0);
}

long long pixels_of(const ReferenceSide& side) {
  return std::accumulate(side.judged.pixels().begin(), side.judged.pixels().end(), 0LL);
}

}  // namespace

ReferenceSide reference_side(const RgbImage& mean, const RgbImage& denominator,
                             const Image<std::uint8_t>& judged, SideParts parts) {
  ReferenceSide side;
  side.judged = judged;
  if (parts.tone || parts.flip) side.exposure = tone_map_exposure(mean, judged);
  if (parts.tone) side.tone = tone_mapped_image(mean, side.exposure, judged);
  if (parts.flip) side.flip = flip_view(scaled_judged(mean, side.exposure, judged));
  if (parts.deciles) side.decile = deciles_of(denominator, judged);
  return side;
}

std::shared_ptr<const ReferenceSide> KeptSide::of(const RgbImage& mean, const RgbImage& denominator,
                                                  const Image<std::uint8_t>& judged,
                                                  SideParts parts) {
  {
    const std::lock_guard lock(mutex_);
    if (side_ && side_->judged == judged && has(*side_, parts)) return side_;
  }
  auto made =
      std::make_shared<const ReferenceSide>(reference_side(mean, denominator, judged, parts));
  const std::lock_guard lock(mutex_);
  // An image with pixels that are no numbers is the exception.
  if (!side_ || pixels_of(*made) >= pixels_of(*side_)) side_ = made;
  return made;
}

}  // namespace spool
