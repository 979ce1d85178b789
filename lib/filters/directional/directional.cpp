// The reconstruction of [LiuZheng (section 4)], step by step in the order of the text.
#include "lib/filters/directional/directional.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/filters/directional/base_image.h"
#include "lib/filters/directional/base_step.h"
#include "lib/filters/directional/filter_size.h"
#include "lib/filters/directional/filter_width.h"
#include "lib/filters/directional/lone_sizes.h"
#include "lib/filters/directional/piece_footprint.h"
#include "lib/filters/directional/sample_filter.h"
#include "lib/filters/directional/tile.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/statistics/grown_variance.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

Plane scaled(const Plane& plane, double factor) {
  Plane result = plane;
  for (double& v : result.pixels())
    v *= factor;
  return result;
}

// At least what enough like pieces around say: all dark samples of a pixel have no variance by
// chance.
void pool_noise(int largest, const Plane& mean, Plane& variance) {
  const Plane grown = grown_variance(variance, largest, &mean);
  for (std::size_t i = 0; i < variance.size(); ++i)
    variance[i] = std::max(variance[i], grown[i]);
}

// Filter size of each piece [LiuZheng (9)]
CountImage sizes_of(const Tile& tile, const Pyramid& pyramid, const DirectionalOptions& options,
                    Views* views, GuardCounts& guards) {
  const int levels = options.pyramid.levels;
  if (tile.channels.empty()) {
    return filter_size({tile.analysis.mean, tile.analysis.variance, tile.n, tile.minimum,
                        tile.maximum, pyramid.coarse, tile.attenuation, levels},
                       options.size, views, guards);
  }
  std::vector<Pyramid> pyramids(tile.channels.size());
  std::vector<FilterSizeInput> inputs;
  for (std::size_t c = 0; c < tile.channels.size(); ++c) {
    const SizeChannel& channel = tile.channels[c];
    if (options.size.coarse == SizeCoarse::kPyramid)
      pyramids[c] = build_pyramid(channel.mean, options.pyramid);
    inputs.push_back({channel.mean, channel.variance, tile.n, channel.minimum, channel.maximum,
                      pyramids[c].coarse, tile.attenuation, levels});
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

// Eqs 10-12 over pieces, or over single samples where they are wanted and have positions.
// `variance`: of the piece means before the base image. The tile's own means and variances are used
// up.
template <class T>
FilteredPieces weighted_means(Tile& tile, const CountImage& level, const FilterWidths<T>& widths,
                              const RgbImage& variance, const SamplePool& pool,
                              const DirectionalOptions& options, GuardCounts& guards) {
  if (variance[0].empty()) {
    FilteredPieces pieces{std::move(tile.pieces.mean), std::move(tile.pieces.variance)};
    filter_in_place(tile.pieces.n, level, widths, options.filter, pieces, guards);
    correct_variance(base_taps(options.base), level, options.width.sigma_max, options.filter,
                     pieces.variance);
    return pieces;
  }
  const FilterInput input{tile.pieces.n, level, tile.pieces.mean, variance};
  FilteredPieces pieces =
      filter_samples(input, widths, pool, tile.x0, tile.y0, options.filter, guards);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level[i] == 0) pieces.variance[c][i] = tile.pieces.variance[c][i];
    }
  }
  return pieces;
}

// Filtered pieces of one pixel are made of the same samples, so that the variance of their mean is
// at most the mean of theirs: average_piece_variance() divides that by q^2, which holds for pieces
// that kept means of their own.
void undo_division(const Plane& raw, BaseImage base, int pieces_per_side, const CountImage& level,
                   RgbImage& variance) {
  if (pieces_per_side == 1) return;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const bool own_mean = base == BaseImage::kNone || (!raw.empty() && raw[i] > 0.0);
    if (level[i] == 0 && own_mean) continue;
    for (Plane& channel : variance)
      channel[i] *= pieces_per_side * pieces_per_side;
  }
}

template <class T>
FilteredTile filter_tile(Tile tile, const SamplePool& pool, const DirectionalOptions& options,
                         Views* views, Footprints* footprints) {
  FilteredTile result;
  const RgbImage own_means = footprints ? tile.pieces.mean : RgbImage{};
  const Plane raw_variance = tile.analysis.variance;
  const bool by_sample =
      options.filter.granularity == FilterGranularity::kSample && pool.recording().has_film();
  const RgbImage sample_variance = by_sample ? tile.pieces.variance : RgbImage{};
  // The base image, where eq 9 does not refuse it
  const Plane raw = apply_base(options, tile, views, result.guards);

  // Coarse and detail images of the final means [LiuZheng (1)-(4)]
  Pyramid pyramid = build_pyramid(tile.analysis.mean, options.pyramid);
  add_pyramid_views(pyramid, views);

  // Filter size of each piece [LiuZheng (9)]; a piece that kept its mean has stopped before
  result.level = sizes_of(tile, pyramid, options, views, result.guards);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] > 0.0) result.level[i] = 0;
  }
  if (!options.size.lone) result.level = without_lone_sizes(result.level, raw, tile.analysis.mean);
  tile.channels.clear();
  tile.analysis.mean = {};
  if (options.width.anisotropy == AnisotropySource::kFilterBank) pyramid.coarse.clear();

  // Directional energies, and from them the widths delta_i
  FilterWidths<T> widths =
      filter_widths<T>(pyramid, raw_variance, result.level, options, views, result.guards);

  // Weighted mean over the region [LiuZheng (10)-(12)]
  result.pieces =
      weighted_means(tile, result.level, widths, sample_variance, pool, options, result.guards);
  undo_division(raw, options.base, pool.pieces_per_side(), result.level, result.pieces.variance);
  if (footprints && !by_sample) {
    tell_footprints<T>(
        {own_means, raw, tile.pieces.n, result.level, widths, options, pool.pieces_per_side()},
        *footprints);
  }
  result.dominant = std::move(widths.dominant);
  if (views) {
    views->add("base_variance", tile.analysis.variance);
    views->add("level", as_plane(result.level));
    views->add("dominant_direction", result.dominant);
  }
  return result;
}

Result<void> check_attenuation(const Selection& selection) {
  const CountImage& n = selection.statistics.n;
  for (const Plane& a : selection.attenuation) {
    if (a.same_size(n)) continue;
    return fail(ErrorCode::kData,
                "selection: attenuation has {} x {} pieces, the counts have {} x {}: hand over "
                "both from one run",
                a.width(), a.height(), n.width(), n.height());
  }
  return {};
}

// Samples taken of a pool.
struct Taken {
  const PieceStatistics& statistics;
  const SamplePool& pool;
};

// What decides about the filter of each piece, in units of the exposed signal.
void set_deciding(const Taken& taken, const DirectionalOptions& options, Tile& tile,
                  GuardCounts& guards) {
  const PieceStatistics& statistics = taken.statistics;
  const VarianceOptions variance{options.var_mode};
  GuardCounts counted_with_channels;
  tile.analysis =
      estimate_analysis(statistics, variance, options.normalise_exposure, counted_with_channels);
  guards.add(Guard::kExposureFallback, counted_with_channels[Guard::kExposureFallback]);
  tile.n = statistics.n;
  if (options.size.variance == SizeVariance::kContrast) {
    const double factor = tile.analysis.exposure / statistics.signal.exposure;
    tile.minimum = scaled(statistics.analysis.minimum, factor);
    tile.maximum = scaled(statistics.analysis.maximum, factor);
  }
  if (options.size.channels == SizeChannels::kPerChannel)
    tile.channels = size_channels(statistics, taken.pool, tile.analysis.exposure, variance);
  if (options.noise_pool == 0) return;
  pool_noise(options.noise_pool, tile.analysis.mean, tile.analysis.variance);
  for (SizeChannel& channel : tile.channels)
    pool_noise(options.noise_pool, channel.mean, channel.variance);
}

// `averaged` under the filters that `deciding` chose.
Result<Reconstruction> filter_by(const Taken& deciding, const Taken& averaged,
                                 std::span<const Plane> attenuation,
                                 const DirectionalOptions& options, const FilterContext& context) {
  Reconstruction result;
  Tile whole;
  set_deciding(deciding, options, whole, result.guards);
  SPOOL_ASSIGN(whole.pieces, estimate_pieces(averaged.statistics, {options.var_mode},
                                             whole.analysis.exposure, result.guards));
  whole.attenuation = attenuation;

  // Tiles that are filtered alone report none.
  Footprints* const footprints =
      options.scope == ReconstructionScope::kGlobal ? context.footprints : nullptr;
  const TileFilter filter = [&](Tile tile, Views* views) {
    return options.precision == Precision::kFloat32
               ? filter_tile<float>(std::move(tile), averaged.pool, options, views, footprints)
               : filter_tile<double>(std::move(tile), averaged.pool, options, views, footprints);
  };
  FilteredTile filtered =
      options.scope == ReconstructionScope::kTile
          ? filter_tiles(whole, options.tile, 1 << options.pyramid.levels, filter, context.views)
          : filter(std::move(whole), context.views);
  result.guards += filtered.guards;

  // A pixel is the mean of its pieces
  const int q = averaged.statistics.pieces_per_side;
  result.image = average_pieces(std::move(filtered.pieces.image), q);
  result.variance = average_piece_variance(std::move(filtered.pieces.variance), q);
  result.level = std::move(filtered.level);
  result.dominant_direction = std::move(filtered.dominant);
  return result;
}

// The mean of two images of independent samples; what else there is, is the first one's.
void average_with(const Reconstruction& other, Reconstruction& result) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < result.image[c].size(); ++i) {
      result.image[c][i] = 0.5 * (result.image[c][i] + other.image[c][i]);
      (*result.variance)[c][i] = 0.25 * ((*result.variance)[c][i] + (*other.variance)[c][i]);
    }
  }
  result.guards += other.guards;
}

// The even samples of each piece under the filters that the odd ones chose, and the other way
// round.
Result<Reconstruction> filter_halves(const Taken& taken, std::span<const Plane> attenuation,
                                     const DirectionalOptions& options,
                                     const FilterContext& context) {
  const SamplePool even_pool = taken.pool.half(0), odd_pool = taken.pool.half(1);
  const PieceStatistics even_statistics = half_statistics(taken.statistics, even_pool, 0),
                        odd_statistics = half_statistics(taken.statistics, odd_pool, 1);
  const Taken even{even_statistics, even_pool}, odd{odd_statistics, odd_pool};
  FilterContext of_odd = context;
  of_odd.views = nullptr;
  Footprints odd_footprints(wanted_pixels(context));
  if (context.footprints) of_odd.footprints = &odd_footprints;
  SPOOL_ASSIGN(Reconstruction result, filter_by(odd, even, attenuation, options, context));
  SPOOL_ASSIGN(const Reconstruction other, filter_by(even, odd, attenuation, options, of_odd));
  average_with(other, result);
  if (context.footprints) context.footprints->average_with(odd_footprints);
  return result;
}

long long count_all(const CountImage& n) {
  long long sum = 0;
  for (const std::int32_t k : n.pixels())
    sum += k;
  return sum;
}

}  // namespace

Result<Reconstruction> reconstruct_directional(const Selection& selection, const SamplePool& pool,
                                               const DirectionalOptions& options,
                                               const FilterContext& context) {
  SPOOL_TRY(check_attenuation(selection));
  const SizeChannels channels = options.size.channels;
  std::optional<PieceStatistics> seen_otherwise;
  if (channels == SizeChannels::kLuminance || channels == SizeChannels::kMaxRgb)
    seen_otherwise = with_analysis_channel(selection.statistics, pool, channels);
  const Taken taken{seen_otherwise ? *seen_otherwise : selection.statistics, pool};
  const CountImage& n = taken.statistics.n;
  const bool two_each = count_all(n) >= 2 * static_cast<long long>(n.size());
  const bool halves = options.decide == Deciding::kHalves;
  SPOOL_ASSIGN(Reconstruction result,
               halves && two_each
                   ? filter_halves(taken, selection.attenuation, options, context)
                   : filter_by(taken, taken, selection.attenuation, options, context));
  if (halves && !two_each) {
    result.notes.emplace_back(
        "directional: decide=halves needs 2 samples a piece on average: all decide");
  }
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
       .readings = directional_readings(),
       .views =
           {
               {"f.k", "coarse images (eqs 1-3)"},
               {"d.k", "detail images (eq 4)"},
               {"S.k", "variance (or contrast) of the mean over regions of level k (eq 9)"},
               {"q.k", "value of regions of level k (eq 9)"},
               {"w.k", "weight of the squared difference (eq 9)"},
               {"T.k", "criterion of the size; positive stops (eq 9); T.base: of the base image"},
               {"stop.k", "1 where the size stops at level k, after the vote; stop.base: before"},
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
       .cost = 0.59,
       .footprints = true,
       .run = reconstruct_directional});
}

}  // namespace spool
