#include "lib/filters/oidn/oidn.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "lib/core/pairwise_sum.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/scene_luminance.h"
#include "lib/statistics/feature_statistics.h"

namespace spool {
namespace {

// [c][y][x] in double to [y][x][c] in float, each value between `least` and `most`.
std::vector<float> interleaved(const RgbImage& image, double factor, double least, double most) {
  std::vector<float> values(3 * image[0].size());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i)
      values[3 * i + c] = static_cast<float>(std::clamp(factor * image[c][i], least, most));
  }
  return values;
}

RgbImage planar(const std::vector<float>& values, int width, int height, double factor) {
  RgbImage image = make_rgb(width, height);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < image[c].size(); ++i)
      image[c][i] = factor * values[3 * i + c];
  }
  return image;
}

// The means of a layer of three channels; nothing where none was recorded.
Result<std::vector<float>> feature(const SamplePool& pool, const CountImage& n,
                                   const std::string& name, double least, GuardCounts& guards) {
  for (const FeatureLayer& layer : pool.recording().features()) {
    if (layer.name != name || layer.components.size() != 3) continue;
    SPOOL_ASSIGN(FeatureStatistics statistics, feature_statistics(pool, n, layer, guards));
    RgbImage mean = {std::move(statistics.mean[0]), std::move(statistics.mean[1]),
                     std::move(statistics.mean[2])};
    return interleaved(average_pieces(std::move(mean), pool.pieces_per_side()), 1.0, least, 1.0);
  }
  return std::vector<float>{};
}

double luminance_sum(const RgbImage& image) {
  return pairwise_sum(image[0].size(), [&](std::size_t i) {
    return luminance(image[0][i], image[1][i], image[2][i]);
  });
}

// A note where the network lost more light than this share allows.
constexpr double kLightKept = 0.98;

void note_lost_light(const RgbImage& mean, Reconstruction& made) {
  const double kept = luminance_sum(made.image), all = luminance_sum(mean);
  if (kept < kLightKept * all)
    made.notes.push_back(
        fmt::format("oidn: the network returned {:.1f} % of the light of its samples; with "
                    "energy=box the image has all of it",
                    100.0 * kept / all));
}

OptionTable<OidnOptions> oidn_option_table() {
  using O = OidnOptions;
  const auto in_settings = [](auto option) {
    OptionTable<O> table;
    append_options<O, OidnSettings>(table, {std::move(option)}, &O::settings);
    return table.front();
  };
  return {
      choice_option<O, OidnFeatures>("features", &O::features,
                                     {{"all", OidnFeatures::kAll},
                                      {"albedo", OidnFeatures::kAlbedo},
                                      {"off", OidnFeatures::kNone}},
                                     "what it uses beside radiance, where it was recorded"),
      in_settings(switch_option("prefilter", &OidnSettings::prefilter,
                                "features are denoised by themselves first")),
      in_settings(choice_option<OidnSettings, OidnQuality>("quality", &OidnSettings::quality,
                                                           {{"high", OidnQuality::kHigh},
                                                            {"balanced", OidnQuality::kBalanced},
                                                            {"fast", OidnQuality::kFast}},
                                                           "of the network, version 2"))};
}

// Of one selection. Errors: kUsage without the library; kData with what the library says.
Result<Reconstruction> reconstruct_oidn(const Selection& selection, const SamplePool& pool,
                                        const OidnOptions& options, const FilterContext&) {
  SPOOL_ASSIGN(const auto library, open_oidn());
  const PieceStatistics& statistics = selection.statistics;
  SPOOL_TRY(check_any_sample(statistics.n));
  Reconstruction result;
  const RgbImage mean = pixel_means(statistics, result.guards);
  const int width = mean[0].width(), height = mean[0].height();
  // A power of two costs no digit: a recording twice as bright gives the same bits.
  const double unit = std::ldexp(1.0, -std::ilogb(scene_luminance(statistics, result.guards)));
  OidnImages images{static_cast<std::size_t>(width),
                    static_cast<std::size_t>(height),
                    interleaved(mean, unit, 0.0, 1e30),
                    {},
                    {}};
  if (options.features != OidnFeatures::kNone) {
    SPOOL_ASSIGN(images.albedo, feature(pool, statistics.n, "albedo", 0.0, result.guards));
  }
  if (options.features == OidnFeatures::kAll && !images.albedo.empty()) {
    SPOOL_ASSIGN(images.normal, feature(pool, statistics.n, "normal", -1.0, result.guards));
  }
  SPOOL_ASSIGN(const std::vector<float> denoised,
               run_oidn(*library, std::move(images), options.settings));
  result.image = planar(denoised, width, height, 1.0 / unit);
  note_lost_light(mean, result);
  return result;
}

}  // namespace

Filter oidn_filter() {
  Filter filter = make_value<FilterFunction, OidnOptions>(
      {.name = "oidn",
       .summary = "Open Image Denoise, where it is installed: a network that others trained",
       .options = oidn_option_table(),
       .needs =
           [](const OidnOptions& options) {
             const bool sees = options.features != OidnFeatures::kNone;
             return Needs{.features = sees ? Use::kWhenRecorded : Use::kNone};
           },
       .memory = {500, 9e7},  // version 2.5.1 on a picture of 256 x 256 pixels
       .cost = 1.5,
       .run = reconstruct_oidn});
  filter.make = [make = filter.make](std::string_view preset,
                                     const OptionValues& set) -> Result<ReadyFilter> {
    SPOOL_ASSIGN(ReadyFilter ready, make(preset, set));
    ready.installed = []() -> Result<void> {
      SPOOL_TRY(open_oidn());
      return {};
    };
    return ready;
  };
  return filter;
}

}  // namespace spool
