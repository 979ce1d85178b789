// The statistics of a selection as an EXR, for samplers and filters outside this program.
//
//   n, left             uint   samples taken of a piece, and how many more it has
//   R, G, B             float  their mean, radiance units; where n is 0, the neighbours'
//   variance.R/G/B      float  estimated variance of that mean
//   albedo.R, normal.X, depth.Z and so on, where asked for and recorded: means over the same
//   samples (lib/statistics/feature_statistics.h); albedo_variance.R and so on, the variances of
//   those means
//
// All have the size of the grid of pieces (pixels, but for --pieces 2).
#pragma once

#include <filesystem>

#include "lib/core/error.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"

namespace spool::tools {

// kData when no piece has a sample.
Result<void> write_statistics(const std::filesystem::path& path, const PieceStatistics& statistics,
                              const SamplePool& pool, bool features);

}  // namespace spool::tools
