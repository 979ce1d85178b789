// The statistics of a selection as an EXR, for samplers and filters outside this program.
//
//   n, left             uint   samples taken of a piece, and how many more it has
//   R, G, B             float  their mean, radiance units; where n is 0, the neighbours'
//   variance.R/G/B      float  estimated variance of that mean
//   albedo.R, normal.X, depth.Z and so on, where asked for and recorded: means over the same
//   samples (lib/statistics/feature_statistics.h); albedo_variance.R and so on, the variances of
//   those means
//   mean_L.R, m2_L.R, m3_L.R, m4_L.R, for each L asked for (0.25, 0.5, 1): of samples transformed
//   with lambda = L, their mean and the sums of the powers of their distances from it
//   (lib/statistics/transformed_moments.h)
//
// All have the size of the grid of pieces (pixels, but for --pieces 2).
#pragma once

#include <filesystem>

#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"

namespace spool::tools {

struct ToldStatistics {
  bool features = false;
  std::vector<double> moments;  // lambda of the transforms
};

// kData when no piece has a sample.
Result<void> write_statistics(const std::filesystem::path& path, const PieceStatistics& statistics,
                              const SamplePool& pool, const ToldStatistics& told);

template <class Options>
OptionTable<Options> told_option_table(ToldStatistics Options::* member) {
  OptionTable<Options> table;
  append_options<Options, ToldStatistics>(
      table,
      {switch_option("features", &ToldStatistics::features,
                     "also hand over the means of albedo, normal and depth, and their variances"),
       choice_option<ToldStatistics, std::vector<double>>(
           "moments", &ToldStatistics::moments,
           {{"off", {}}, {"1", {1.0}}, {"0.5", {0.5}}, {"0.25", {0.25}}, {"0.25+1", {0.25, 1.0}}},
           "also hand over mean, m2, m3 and m4 of samples transformed with these lambda")},
      member);
  return table;
}

}  // namespace spool::tools
