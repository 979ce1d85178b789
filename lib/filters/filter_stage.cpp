#include "lib/filters/filter_stage.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "lib/kernels/energy_step.h"
#include "lib/kernels/returned_residual.h"
#include "lib/kernels/sample_clamp.h"
#include "lib/kernels/scene_luminance.h"

namespace spool {
namespace {

enum class EnergyStage { kOff, kBox, kFirst };
enum class ResidualStage { kOff, kHalves };

// Bytes a pixel: the clamped samples' statistics, the image that is restored.
constexpr double kClampMemory = 70, kResidualMemory = 120, kEnergyMemory = 16;

// Of light that a sampler lost, which may have been anywhere but in a lamp (decision 159).
constexpr EnergyStepOptions kOfFirstSamples = {.floor = 0.5, .top = 1.0};

struct StageOptions {
  bool clamp = false;
  ResidualStage residual = ResidualStage::kOff;
  EnergyStage energy = EnergyStage::kOff;

  bool behind() const { return residual != ResidualStage::kOff || energy != EnergyStage::kOff; }
};

OptionTable<StageOptions> stage_option_table() {
  return {
      switch_option("clamp", &StageOptions::clamp,
                    "samples far above what those around them allow are scaled down before"),
      choice_option<StageOptions, ResidualStage>(
          "residual", &StageOptions::residual,
          {{"off", ResidualStage::kOff}, {"halves", ResidualStage::kHalves}},
          "what two halves of the samples agree that the filter took away comes back"),
      choice_option<StageOptions, EnergyStage>(
          "energy", &StageOptions::energy,
          {{"off", EnergyStage::kOff}, {"box", EnergyStage::kBox}, {"first", EnergyStage::kFirst}},
          "the image gets the energy of the samples' mean, where it costs the least; first: of the "
          "samples that every piece has, which no sampler chose")};
}

// The options of the stage that the filter does not have itself.
OptionTable<StageOptions> table_beside(const Filter& filter) {
  OptionTable<StageOptions> table = stage_option_table();
  for (const OptionDescription& own : filter.describe(""))
    std::erase_if(table,
                  [&](const Option<StageOptions>& option) { return option.name == own.name; });
  return table;
}

// The first samples of each piece, as many as every piece that is not exhausted has: a sampler took
// them whatever it saw. All that were taken where some piece has none.
PieceStatistics first_samples(const PieceStatistics& taken, const SamplePool& pool) {
  CountImage n = taken.n;
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      if (n(x, y) < pool.capacity(x, y)) least = std::min(least, n(x, y));
    }
  }
  if (least == 0) return taken;
  for (std::int32_t& count : n.pixels())
    count = std::min(count, least);
  return prefix_means(pool, n);
}

RgbImage with_energy(RgbImage image, EnergyStage energy, const Selection& selection,
                     const SamplePool& pool, double unit, GuardCounts& guards) {
  GuardCounts counted_by_the_filter;
  const bool first = energy == EnergyStage::kFirst;
  const RgbImage mean =
      first ? pixel_means(first_samples(selection.statistics, pool), counted_by_the_filter)
            : pixel_means(selection.statistics, counted_by_the_filter);
  return restore_energy(std::move(image), mean, unit, first ? kOfFirstSamples : EnergyStepOptions{},
                        guards);
}

Result<Reconstruction> run_stage(const FilterFunction& filter, const StageOptions& options,
                                 const Selection& selection, const SamplePool& pool,
                                 const FilterContext& context) {
  GuardCounts guards;
  FilterContext inner = context;
  if (options.behind()) inner.footprints = nullptr;  // its image is not the last
  Result<Reconstruction> result = [&] {
    if (!options.clamp) return filter(selection, pool, inner);
    const ClampedSamples clamped = clamp_samples(selection, pool, {}, guards);
    return filter(clamped.selection, clamped.pool, inner);
  }();
  if (!result) return result;
  if (options.behind()) {
    const int q = pool.pieces_per_side();
    const CountImage& n = selection.statistics.n;
    RgbImage& image = result->image;
    if (image[0].width() != n.width() / q || image[0].height() != n.height() / q)
      return result;  // the caller reports it
    const double unit = scene_luminance(selection.statistics, guards);
    if (options.residual == ResidualStage::kHalves)
      image = return_residual(std::move(image), selection, pool, unit, guards);
    if (options.energy != EnergyStage::kOff)
      image = with_energy(std::move(image), options.energy, selection, pool, unit, guards);
  }
  result->guards += guards;
  return result;
}

}  // namespace

std::vector<OptionDescription> stage_options() {
  return describe_options(stage_option_table(), StageOptions{});
}

Filter with_stage_options(Filter filter, OwnOptions own) {
  const OptionTable<StageOptions> table = table_beside(filter);
  Filter staged = filter;
  staged.describe = [filter, table](std::string_view preset) {
    std::vector<OptionDescription> all = filter.describe(preset);
    for (OptionDescription& option : describe_options(table, StageOptions{}))
      all.push_back(std::move(option));
    return all;
  };
  staged.make = [filter, table, own](std::string_view preset,
                                     const OptionValues& set) -> Result<ReadyFilter> {
    const std::vector<std::string> of_the_stage = names_of(table);
    std::vector<std::string> known = names_of(filter.describe(preset));
    known.insert(known.end(), of_the_stage.begin(), of_the_stage.end());
    OptionValues of_stage, of_filter;
    for (const auto& value : set) {
      if (own == OwnOptions::kDescribed && std::ranges::find(known, value.first) == known.end())
        return fail(ErrorCode::kUsage, "{}", unknown_name("option", value.first, known));
      const bool here = std::ranges::find(of_the_stage, value.first) != of_the_stage.end();
      (here ? of_stage : of_filter).push_back(value);
    }
    SPOOL_ASSIGN(const StageOptions options, with_options(table, StageOptions{}, of_stage));
    SPOOL_ASSIGN(ReadyFilter ready, filter.make(preset, of_filter));
    if (!options.clamp && !options.behind()) return ready;
    ready.needs.signal = ready.needs.variance = true;
    if (options.residual != ResidualStage::kOff) ready.needs.pool = true;
    if (options.clamp) ready.memory.per_pixel += kClampMemory;
    if (options.residual != ResidualStage::kOff) ready.memory.per_pixel += kResidualMemory;
    if (options.energy != EnergyStage::kOff) ready.memory.per_pixel += kEnergyMemory;
    ready.run = [run = std::move(ready.run), options](const Selection& selection,
                                                      const SamplePool& pool,
                                                      const FilterContext& context) {
      return run_stage(run, options, selection, pool, context);
    };
    return ready;
  };
  return staged;
}

}  // namespace spool
