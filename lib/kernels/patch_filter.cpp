#include "lib/kernels/patch_filter.h"

#include <algorithm>

#include "lib/core/parallel.h"

namespace spool {
namespace {

// Pieces whose distances, weights and sums are computed together: all that an offset reads and
// writes stays in the cache of one core.
constexpr int kTileWidth = 128, kTileHeight = 64;

}  // namespace

void filter_tiles(
    std::span<const GuidedTargets> guided, const PatchFilterOptions& options,
    const std::function<void(const Rectangle&, std::span<const std::vector<Plane>>)>& use) {
  const int width = guided[0].targets[0]->width(), height = guided[0].targets[0]->height();
  const int across = (width + kTileWidth - 1) / kTileWidth;
  const int down = (height + kTileHeight - 1) / kTileHeight;
  parallel_for(static_cast<std::size_t>(across) * static_cast<std::size_t>(down),
               [&](std::size_t i) {
                 const int x0 = static_cast<int>(i) % across * kTileWidth;
                 const int y0 = static_cast<int>(i) / across * kTileHeight;
                 const Rectangle tile = {x0, y0, std::min(x0 + kTileWidth, width),
                                         std::min(y0 + kTileHeight, height)};
                 std::vector<std::vector<Plane>> filtered;
                 for (const GuidedTargets& targets : guided)
                   filtered.push_back(filter_tile(targets, options, tile));
                 use(tile, filtered);
               });
}

OptionTable<PatchFilterOptions> patch_filter_option_table() {
  using O = PatchFilterOptions;
  return {
      integer_option<O>("window", &O::window, 1, 64, "radius searched, pixels"),
      expert(
          integer_option<O>("patch", &O::patch, 0, 16, "radius of the patches compared, pixels")),
      number_option<O>("kappa", &O::kappa, 1e-3, 100.0, "damping: larger filters more"),
  };
}

}  // namespace spool
