#include "lib/filters/ensemble.h"

#include <algorithm>
#include <utility>

#include "lib/filters/ensemble_weights.h"
#include "lib/kernels/scene_luminance.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

constexpr int kEnoughSamples = 3;       // halves of one sample each cannot order the parts
constexpr double kWeightsMemory = 320;  // bytes a pixel beside the parts' images

class Ensemble {
 public:
  Ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options)
      : parts_(std::move(parts)), options_(options) {}

  Result<Reconstruction> operator()(const Selection& selection, const SamplePool& pool,
                                    const FilterContext& context) const {
    const bool enough = std::ranges::all_of(selection.statistics.n.pixels(),
                                            [](int n) { return n >= kEnoughSamples; });
    const bool halves = options_.weights == EnsembleWeights::kHalves;
    const bool split = halves && enough;
    const double runs = split ? 3.0 : 1.0;
    Reconstruction result;
    SPOOL_ASSIGN(const std::vector<RgbImage> whole,
                 images(selection, pool, context, 0.0, runs, result));
    std::vector<const RgbImage*> all;
    for (const RgbImage& image : whole)
      all.push_back(&image);
    result.image = mean_of(all);
    if (halves && !enough)
      result.notes.emplace_back(
          "ensemble: weights=halves needs 3 samples in every piece: equal weights");
    if (!split) return result;
    std::vector<HalfImages> of_halves(parts_.size());
    HalfImages means;
    for (int h = 0; h < 2; ++h) {
      const auto side = static_cast<std::size_t>(h);
      const SamplePool half_pool = pool.half(h);
      const Selection half{half_statistics(selection.statistics, half_pool, h),
                           selection.attenuation};
      means[side] = pixel_means(prefix_means(pool.without_limits().half(h), half.statistics.n),
                                result.guards);
      SPOOL_ASSIGN(std::vector<RgbImage> found,
                   images(half, half_pool, context, 1.0 + h, runs, result));
      for (std::size_t k = 0; k < parts_.size(); ++k)
        of_halves[k][side] = std::move(found[k]);
    }
    const std::vector<Plane> weights = cross_fitted_weights(
        of_halves, means, scene_luminance(selection.statistics, result.guards));
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < weights[0].size(); ++p) {
        double sum = 0.0;
        for (std::size_t k = 0; k < whole.size(); ++k)
          sum += weights[k][p] * whole[k][c][p];
        result.image[c][p] = sum;
      }
    }
    return result;
  }

 private:
  // One of each part; their notes and guards go to `result`.
  Result<std::vector<RgbImage>> images(const Selection& selection, const SamplePool& pool,
                                       const FilterContext& context, double done, double runs,
                                       Reconstruction& result) const {
    std::vector<RgbImage> found;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      FilterContext of_part = context;
      of_part.views = nullptr;
      of_part.footprints = nullptr;
      of_part.variance = false;
      const auto n = static_cast<double>(parts_.size());
      if (context.progress) {
        of_part.progress = [&, k](double share) {
          context.progress((done + (static_cast<double>(k) + share) / n) / runs);
        };
      }
      SPOOL_ASSIGN(Reconstruction one, parts_[k](selection, pool, of_part));
      if (!found.empty() && !one.image[0].same_size(found[0][0])) {
        return fail(
            ErrorCode::kData, "ensemble: its parts have images of {} x {} and {} x {} pixels",
            found[0][0].width(), found[0][0].height(), one.image[0].width(), one.image[0].height());
      }
      for (std::string& note : one.notes) {
        if (std::ranges::find(result.notes, note) == result.notes.end())
          result.notes.push_back(std::move(note));
      }
      result.guards += one.guards;
      result.exchange_seconds += one.exchange_seconds;
      found.push_back(std::move(one.image));
    }
    return found;
  }

  std::vector<ReadyFilter> parts_;
  EnsembleOptions options_;
};

// One part works at a time.
void add_part(WorkingMemory& memory, const WorkingMemory& part) {
  memory.per_pixel = std::max(memory.per_pixel, part.per_pixel);
  memory.fixed += part.fixed;
}

Needs needs_of(const std::vector<ReadyFilter>& parts, bool halves) {
  Needs needs{.signal = false, .variance = false, .pool = false, .samples = false};
  for (const ReadyFilter& part : parts) {
    needs.features = std::max(needs.features, part.needs.features);
    needs.film_positions = std::max(needs.film_positions, part.needs.film_positions);
    needs.reference = needs.reference || part.needs.reference;
    needs.signal = needs.signal || part.needs.signal;
    needs.variance = needs.variance || part.needs.variance;
    needs.pool = needs.pool || part.needs.pool;
    needs.samples = needs.samples || part.needs.samples;
  }
  needs.signal = needs.signal || halves;
  needs.variance = needs.variance || halves;
  needs.pool = needs.pool || halves;
  return needs;
}

}  // namespace

OptionTable<EnsembleOptions> ensemble_option_table() {
  return {choice_option<EnsembleOptions, EnsembleWeights>(
      "weights", &EnsembleOptions::weights,
      {{"mean", EnsembleWeights::kMean}, {"halves", EnsembleWeights::kHalves}},
      "mean: equal; halves: by the error that two halves of the samples show, at three times the "
      "cost")};
}

ReadyFilter ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options) {
  SPOOL_CHECK_GE(parts.size(), std::size_t{2});
  SPOOL_CHECK_LE(parts.size(), kMostEnsembleParts);
  const bool halves = options.weights == EnsembleWeights::kHalves;
  // Their images stay while the next part works; 24 bytes a pixel each.
  const double kept = 24.0 * static_cast<double>(parts.size()) * (halves ? 3.0 : 1.0) +
                      (halves ? kWeightsMemory : 0.0);
  WorkingMemory memory, of_means;
  for (const ReadyFilter& part : parts) {
    add_part(memory, part.memory);
    add_part(of_means, part.memory_of_means.value_or(part.memory));
  }
  memory.per_pixel += kept;
  of_means.per_pixel += kept;
  Needs needs = needs_of(parts, halves);
  return {Ensemble(std::move(parts), options), std::move(needs), memory, of_means};
}

}  // namespace spool
