// Averages pixels whose patches look alike in another image [RousselleKnausZwicker12].
//
//   d2(p, q) = mean over channels of ((a_p - a_q)^2 - alpha (v_p + min(v_q, v_p)))
//              / (1e-10 + kappa^2 (v_p + v_q))
//   w = box(exp(-max(0, box(d2)))) with boxes over the patch of (2 f + 1)^2, 0 below 0.05, and 1 at
//   the centre; result(p) = sum of w target_q / sum of w over |q - p| <= r in x and y
//
// a, v: means and variances of the guide. Borders are mirrored. Distances, weights and the sums
// over a row of the window - of what targets differ from the piece's own - are float, sums over its
// rows double; for that, means count as at most 1e15 and kappa^2 v as at most 1e10. Tiles run in
// parallel, and every piece's sum takes the offsets in one order, so bits do not depend on threads.
// Slow twin: tests/reference/nl_means_reference.h.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/kernels/patch_tile.h"

namespace spool {

OptionTable<PatchFilterOptions> patch_filter_option_table();

// Calls `use` with every tile of the image and what is filtered there, [guided][target][y][x] from
// the tile's corner; in parallel.
void filter_tiles(std::span<const GuidedTargets> guided, const PatchFilterOptions& options,
                  const std::function<void(const Rectangle& tile,
                                           std::span<const std::vector<Plane>> filtered)>& use);

}  // namespace spool
