// What greedy error minimisation looks at (lib/sampling/greedy_error.h): the error of every pixel
// and the scale at which it has it.
#pragma once

#include <optional>

#include "lib/core/option_table.h"
#include "lib/kernels/scale_ladder.h"

namespace spool {

struct GreedyErrorOptions {
  // Per piece; empty: default_initial_samples(), as every sampler takes. Fewer than 4 need the
  // pooled variance.
  std::optional<int> init_spp;
  int iterations = 8;
  int scales = 4;  // above the base image
  double gamma = 0.2;
  double alpha = 1.0;  // blur of the stop maps / sigma
  GreedyGrid grid = GreedyGrid::kAuto;
  VarianceMode var_mode = VarianceMode::kAuto;
};

const OptionTable<GreedyErrorOptions>& greedy_error_option_table();

// sigma_s of the sampling phase, s >= 1, pixels.
inline double greedy_sampling_scale(int s) {
  return static_cast<double>(1 << (s - 1));
}

struct GreedyErrorMap {
  Plane error;       // e [y][x] of pixels, >= 0
  CountImage scale;  // selected scale, 0: base image
};

// `per_pixel` is m. `kept`, where not null: what it kept of fewer samples, and keeps of these (on
// the subpixel grid alone).
Result<GreedyErrorMap> greedy_error_map(const PieceStatistics& statistics, const SamplePool& pool,
                                        double per_pixel, const GreedyErrorOptions& options,
                                        GuardCounts& guards, KeptImage* kept = nullptr);

}  // namespace spool
