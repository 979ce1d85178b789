// Where a filter is unsure of itself: what samplers with a filter in their loop go by.
//
// The samples so far are split in halves A, B (even and odd ones); both are filtered:
//
//   e = mean_c (F(A) - F(B))^2 / (F^2 + 0.01),  F = (F(A) + F(B)) / 2,  smoothed with a Gaussian
//
// Radiance is exposed to mean 1. The wanted count of a pixel is proportional to sqrt(e).
#pragma once

#include "lib/core/option_table.h"
#include "lib/sampling/sampler.h"

namespace spool {

// sqrt(e) [y][x] of pixels. `error`, where not null, gets e before the smoothing (sigma `blur`,
// pixels). Errors: those of the filter.
Result<Plane> filter_disagreement(const PieceStatistics& statistics, const SamplePool& pool,
                                  const LoopFilter& filter, double blur, Plane* error = nullptr);

// Samples to take in a round: `share` over the pieces that have fewer than they are worth, where
// the worth of a piece is proportional to `weight` and sums to all samples so far and the share.
CountImage hand_out_deficits(const Plane& weight, const CountImage& n, const SamplePool& pool,
                             long long share);

// A value of pixels in equal parts over the pieces of each.
Plane pixels_to_pieces(const Plane& pixels, int pieces_per_side);

// kUsage when the context has no filter for `sampler` to ask.
Result<void> check_loop(const SamplingContext& context, std::string_view sampler);

// The option that names the filter in the loop.
inline constexpr const char* kBeside = "beside";
inline constexpr const char* kDefaultLoopFilter = "twin_guides";

template <class Options>
Option<Options> loop_filter_option(std::string Options::* member) {
  return {"filter", "beside|NAME",
          "in the loop: a filter by its name, or beside: the filter of the image",
          [member](Options& options, std::string_view text) -> Result<void> {
            if (text.empty()) {
              return fail(ErrorCode::kUsage,
                          "option filter: is empty: name a filter, or say beside");
            }
            options.*member = text;
            return {};
          },
          [member](const Options& options) { return options.*member; }};
}

// What a sampler with this filter in its loop needs.
inline Needs loop_needs(const std::string& filter) {
  return {.filter_in_loop = true, .loop_filter = filter == kBeside ? "" : filter};
}

}  // namespace spool
