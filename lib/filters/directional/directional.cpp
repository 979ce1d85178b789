// The reconstruction of [LiuZheng (section 4)], step by step in the order of the text.
#include "lib/filters/directional/directional.h"

#include <utility>

#include "lib/core/parallel.h"
#include "lib/filters/directional/filter_size.h"
#include "lib/filters/directional/filter_width.h"
#include "lib/filters/directional/part.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {
namespace {

Plane as_plane(const CountImage& image) {
  Plane plane(image.width(), image.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = image[i];
  return plane;
}

Plane scaled(const Plane& plane, double factor) {
  Plane result = plane;
  for (double& v : result.pixels())
    v *= factor;
  return result;
}

Taps squared(Taps taps) {
  for (double& tap : taps.values)
    tap *= tap;
  return taps;
}

// The image that size 1 means: piece means, each mixed with its eight neighbours.
void apply_base(const Taps& taps, RgbImage& mean, RgbImage* variance, Plane& analysis_mean,
                Plane& analysis_variance) {
  if (taps.values.size() == 1) return;
  for (Plane& channel : mean)
    channel = convolve(channel, taps);
  for (std::size_t c = 0; variance && c < 3; ++c)
    (*variance)[c] = convolve((*variance)[c], squared(taps));
  analysis_mean = convolve(analysis_mean, taps);
  analysis_variance = convolve(analysis_variance, squared(taps));
}

// Filter size of each piece [LiuZheng (9)]
CountImage sizes_of(Part& part, const Pyramid& pyramid, const Taps& base,
                    const DirectionalOptions& options, Views* views, GuardCounts& guards) {
  const int levels = options.pyramid.levels;
  if (part.channels.empty()) {
    return filter_size({part.analysis.mean, part.analysis.variance, part.pieces.n, part.minimum,
                        part.maximum, pyramid.coarse, part.attenuation, levels},
                       options.size, views, guards);
  }
  std::vector<Pyramid> pyramids(part.channels.size());
  std::vector<FilterSizeInput> inputs;
  for (std::size_t c = 0; c < part.channels.size(); ++c) {
    SizeChannel& channel = part.channels[c];
    if (base.values.size() > 1) {
      channel.mean = convolve(channel.mean, base);
      channel.variance = convolve(channel.variance, squared(base));
    }
    if (options.size.coarse == SizeCoarse::kLaplace) {
      pyramids[c] = build_pyramid(channel.mean, options.pyramid);
    }
    inputs.push_back({channel.mean, channel.variance, part.pieces.n, channel.minimum,
                      channel.maximum, pyramids[c].coarse, part.attenuation, levels});
  }
  return filter_size(inputs, options.size, views, guards);
}

void add_pyramid_views(const Pyramid& pyramid, Views* views) {
  if (!views) return;
  for (std::size_t k = 0; k < pyramid.coarse.size(); ++k)
    views->add(fmt::format("f.{}", k), pyramid.coarse[k]);
  for (std::size_t k = 0; k < pyramid.detail.size(); ++k)
    views->add(fmt::format("d.{}", k), pyramid.detail[k]);
}

// The variance of filtered pieces whose inputs the base image had made dependent.
void correct_variance(const Taps& base, const CountImage& level, const DirectionalOptions& options,
                      RgbImage& variance) {
  std::vector<double> factors = {1.0};
  for (int k = 1; k <= options.pyramid.levels; ++k) {
    factors.push_back(
        correlation_factor(base, k, options.width.sigma_max * std::ldexp(1.0, k), options.filter));
  }
  for (Plane& channel : variance) {
    for (std::size_t i = 0; i < channel.size(); ++i)
      channel[i] *= factors[static_cast<std::size_t>(level[i])];
  }
}

template <class T>
FilteredPart filter_part(Part part, const SamplePool& pool, const DirectionalOptions& options,
                         Views* views) {
  FilteredPart result;
  const Plane raw_variance = part.analysis.variance;
  const Taps base = base_taps(options.base);
  const bool by_sample =
      options.filter.granularity == FilterGranularity::kSample && pool.recording().has_film();
  const RgbImage sample_variance =
      by_sample && options.variance ? part.pieces.variance : RgbImage{};
  apply_base(base, part.pieces.mean, options.variance ? &part.pieces.variance : nullptr,
             part.analysis.mean, part.analysis.variance);

  // Coarse and detail images of the final means [LiuZheng (1)-(4)]
  Pyramid pyramid = build_pyramid(part.analysis.mean, options.pyramid);
  add_pyramid_views(pyramid, views);

  // Filter size of each piece [LiuZheng (9)]
  result.level = sizes_of(part, pyramid, base, options, views, result.guards);
  part.channels.clear();
  part.analysis.mean = {};
  if (options.width.anisotropy == AnisotropySource::kFilterBank) pyramid.coarse.clear();

  // Directional energies, and from them the widths delta_i
  FilterWidths<T> widths =
      filter_widths<T>(pyramid, raw_variance, result.level, options, views, result.guards);

  // Weighted mean over the region [LiuZheng (10)-(12)]
  if (by_sample) {
    const FilterInput input{part.pieces.n, result.level, part.pieces.mean,
                            options.variance ? &sample_variance : nullptr};
    result.pieces =
        filter_samples(input, widths, pool, part.x0, part.y0, options.filter, result.guards);
    for (std::size_t c = 0; options.variance && c < 3; ++c) {
      for (std::size_t i = 0; i < result.level.size(); ++i) {
        if (result.level[i] == 0) (*result.pieces.variance)[c][i] = part.pieces.variance[c][i];
      }
    }
  } else {
    const FilterInput input{part.pieces.n, result.level, part.pieces.mean,
                            options.variance ? &part.pieces.variance : nullptr};
    result.pieces = filter_pieces(input, widths, options.filter, result.guards);
    if (options.variance) correct_variance(base, result.level, options, *result.pieces.variance);
  }
  result.dominant = std::move(widths.dominant);
  if (views) {
    views->add("base_variance", part.analysis.variance);
    views->add("level", as_plane(result.level));
    views->add("dominant_direction", result.dominant);
  }
  return result;
}

FilteredPart filter_any(Part part, const SamplePool& pool, const DirectionalOptions& options,
                        Views* views) {
  return options.precision == Precision::kFloat32
             ? filter_part<float>(std::move(part), pool, options, views)
             : filter_part<double>(std::move(part), pool, options, views);
}

// Every tile as if it were the whole image.
FilteredPart filter_tiles(const Part& whole, const SamplePool& pool,
                          const DirectionalOptions& options, Views* views) {
  const Rectangle bounds = whole.pieces.n.bounds();
  const std::vector<Rectangle> tiles = cut_tiles(bounds, options.tile, 1 << options.pyramid.levels);
  std::vector<FilteredPart> parts(tiles.size());
  std::vector<Views> tile_views(tiles.size(), views ? Views(views->wanted()) : Views());
  parallel_for(tiles.size(), [&](std::size_t t) {
    parts[t] = filter_any(crop(whole, tiles[t]), pool, options, views ? &tile_views[t] : nullptr);
  });
  FilteredPart result;
  const int width = bounds.width(), height = bounds.height();
  result.pieces.image = make_rgb(width, height);
  if (options.variance) result.pieces.variance = make_rgb(width, height);
  result.level = CountImage(width, height);
  result.dominant = Plane(width, height);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      paste(parts[t].pieces.image[c], tiles[t], result.pieces.image[c]);
      if (options.variance) {
        paste((*parts[t].pieces.variance)[c], tiles[t], (*result.pieces.variance)[c]);
      }
    }
    paste(parts[t].level, tiles[t], result.level);
    paste(parts[t].dominant, tiles[t], result.dominant);
    result.guards += parts[t].guards;
  }
  if (views) join_views(tile_views, tiles, bounds, *views);
  return result;
}

}  // namespace

Result<Reconstruction> reconstruct_directional(const Selection& selection, const SamplePool& pool,
                                               const DirectionalOptions& options,
                                               const FilterContext& context) {
  const PieceStatistics& taken = selection.statistics;
  for (const Plane& a : selection.attenuation) {
    if (!a.same_size(taken.n)) {
      return fail(ErrorCode::kData,
                  "selection: attenuation has {} x {} pieces, the counts have {} x {}: hand over "
                  "both from one run",
                  a.width(), a.height(), taken.width(), taken.height());
    }
  }
  const SizeChannels channels = options.size.channels;
  std::optional<PieceStatistics> seen_otherwise;
  if (channels == SizeChannels::kLuminance || channels == SizeChannels::kMaxRgb) {
    seen_otherwise = with_analysis_channel(taken, pool, channels);
  }
  const PieceStatistics& statistics = seen_otherwise ? *seen_otherwise : taken;
  Reconstruction result;

  // Statistics of the selection, in units of the exposed signal where something is decided
  const VarianceOptions variance{options.var_mode, options.nu0, options.key};
  Part whole;
  GuardCounts counted_with_channels;
  whole.analysis =
      estimate_analysis(statistics, variance, options.normalise_exposure, counted_with_channels);
  result.guards.add(Guard::kExposureFallback, counted_with_channels[Guard::kExposureFallback]);
  SPOOL_ASSIGN(whole.pieces,
               estimate_pieces(statistics, variance, whole.analysis.exposure, result.guards));
  if (options.size.variance == SizeVariance::kContrast) {
    const double factor = whole.analysis.exposure / statistics.signal.exposure;
    whole.minimum = scaled(statistics.analysis.minimum, factor);
    whole.maximum = scaled(statistics.analysis.maximum, factor);
  }
  if (channels == SizeChannels::kPerChannel) {
    whole.channels = size_channels(statistics, pool, whole.analysis.exposure, variance);
  }
  whole.attenuation = selection.attenuation;

  FilteredPart filtered = options.scope == ReconstructionScope::kTile
                              ? filter_tiles(whole, pool, options, context.views)
                              : filter_any(std::move(whole), pool, options, context.views);
  result.guards += filtered.guards;

  // A pixel is the mean of its pieces
  const int q = statistics.pieces_per_side;
  result.image = average_pieces(std::move(filtered.pieces.image), q);
  if (filtered.pieces.variance) {
    result.variance = average_piece_variance(std::move(*filtered.pieces.variance), q);
  }
  result.level = std::move(filtered.level);
  result.dominant_direction = std::move(filtered.dominant);
  if (context.progress) context.progress(1.0);
  return result;
}

Filter directional_filter() {
  return make_value<FilterFunction, DirectionalOptions>(
      {.name = "directional",
       .summary = "anisotropic mean over a neighbourhood sized by bias and variance",
       .options = directional_option_table(),
       .presets = {{"robust", robust_directional_options()},
                   {"paper", paper_directional_options()}},
       .views =
           {
               {"f.k", "coarse images (eqs 1-3)"},
               {"d.k", "detail images (eq 4)"},
               {"S.k", "variance (or contrast) of the mean over regions of level k (eq 9)"},
               {"q.k", "value of regions of level k (eq 9)"},
               {"w.k", "weight of the squared difference (eq 9)"},
               {"T.k", "criterion of the size; positive stops (eq 9)"},
               {"stop.k", "1 where the size stops at level k, after the vote"},
               {"base_variance", "variance of the base image, analysis signal"},
               {"level", "chosen size: 2^level pieces"},
               {"band_energy.k.i", "energy of direction i at level k"},
               {"delta.i", "width of the filter along direction i, pieces (eq 12)"},
               {"dominant_direction", "direction of the widest extent, degrees; NaN where round"},
           },
       .needs =
           [](const DirectionalOptions& options) {
             const bool inside = options.filter.granularity == FilterGranularity::kSample;
             return Needs{.film_positions = inside ? Use::kWhenRecorded : Use::kNone};
           },
       .memory = {370, 2.6e6},
       .run = reconstruct_directional});
}

}  // namespace spool
