#include "lib/kernels/patch_filter.h"

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
  parallel_tiles(guided[0].targets[0]->bounds(), kTileWidth, kTileHeight,
                 [&](const Rectangle& tile) {
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
