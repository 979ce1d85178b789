#include "tools/methods/statistics_file.h"

#include <utility>

#include "lib/image_io/exr_image.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/transformed_moments.h"

namespace spool::tools {
namespace {

void add_moments(ExrFile& file, const SamplePool& pool, const CountImage& n, double lambda) {
  TransformedMoments moments = transformed_moments(pool, n, 1.0, lambda, HighestMoment::kFourth);
  for (auto [name, image] : {std::pair{"mean", &moments.mean}, std::pair{"m2", &moments.m2},
                             std::pair{"m3", &moments.m3}, std::pair{"m4", &moments.m4}}) {
    for (std::size_t c = 0; c < 3; ++c) {
      file.channels.push_back({fmt::format("{}_{}.{}", name, lambda, "RGB"[c]), PixelType::kFloat,
                               std::move((*image)[c])});
    }
  }
}

}  // namespace

Result<void> write_statistics(const std::filesystem::path& path, const PieceStatistics& statistics,
                              const SamplePool& pool, const ToldStatistics& told) {
  GuardCounts guards;  // of a copy for others; the method that asks counts its own
  SPOOL_ASSIGN(PieceEstimates pieces,
               estimate_pieces(statistics, {}, statistics.signal.exposure, guards));
  ExrFile file = exr_from_rgb(pieces.mean);
  for (std::size_t c = 0; c < 3; ++c) {
    file.channels.push_back(
        {std::string("variance.") + "RGB"[c], PixelType::kFloat, std::move(pieces.variance[c])});
  }
  Plane n(file.width, file.height), left(file.width, file.height);
  for (int y = 0; y < file.height; ++y) {
    for (int x = 0; x < file.width; ++x) {
      n(x, y) = statistics.n(x, y);
      left(x, y) = pool.capacity(x, y) - statistics.n(x, y);
    }
  }
  file.channels.push_back({"n", PixelType::kUint, std::move(n)});
  file.channels.push_back({"left", PixelType::kUint, std::move(left)});
  for (const double lambda : told.moments)
    add_moments(file, pool, statistics.n, lambda);
  if (told.features) {
    SPOOL_ASSIGN(const auto layers, feature_statistics(pool, statistics.n, guards));
    for (const FeatureStatistics& feature : layers) {
      for (std::size_t c = 0; c < feature.mean.size(); ++c) {
        file.channels.push_back(
            {fmt::format("{}.{}", feature.layer.name, feature.layer.components[c]),
             PixelType::kFloat, feature.mean[c]});
        file.channels.push_back(
            {fmt::format("{}_variance.{}", feature.layer.name, feature.layer.components[c]),
             PixelType::kFloat, feature.variance[c]});
      }
    }
  }
  return write_exr(path, file);
}

}  // namespace spool::tools
