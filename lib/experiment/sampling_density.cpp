#include "lib/experiment/sampling_density.h"

#include <map>

#include "lib/statistics/block_jump.h"
#include "lib/statistics/edge_share.h"

namespace spool {
namespace {

constexpr int kBlock = 16;  // pixels: the side of the largest regions and dyadic blocks

// How many pieces gave how many samples, as of a list of a whole pixel: a half of the recording
// and a quarter of a pixel have lists that are shorter by as much.
std::vector<std::pair<int, long long>> counts_of(const std::vector<SampledPart>& parts) {
  std::map<int, long long> pieces;
  for (const SampledPart& part : parts) {
    const int q = part.pool.pieces_per_side();
    const int scale = static_cast<int>(parts.size()) * q * q;
    for (const int n : part.sampled.selection.statistics.n.pixels())
      ++pieces[n * scale];
  }
  return {pieces.begin(), pieces.end()};
}

Plane luminance_of(const RgbImage& image) {
  Plane y(image[0].width(), image[0].height());
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = luminance(image[0][i], image[1][i], image[2][i]);
  return y;
}

}  // namespace

SamplingDensity density_of(const std::vector<SampledPart>& parts) {
  SamplingDensity density{counts_of(parts)};
  const double share = 1.0 / static_cast<double>(parts.size());
  for (const SampledPart& part : parts) {
    const CountImage& counts = part.sampled.selection.statistics.n;
    density.block_jump += share * block_jump(counts, kBlock * part.pool.pieces_per_side());
    density.edge_share += share * edge_share(counts, luminance_of(part.reference.mean));
  }
  return density;
}

}  // namespace spool
