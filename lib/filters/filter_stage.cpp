#include "lib/filters/filter_stage.h"

#include <algorithm>
#include <utility>

#include "lib/kernels/energy_step.h"
#include "lib/kernels/sample_clamp.h"
#include "lib/kernels/scene_luminance.h"

namespace spool {
namespace {

enum class EnergyStage { kOff, kBox };

// Bytes a pixel: the clamped samples' statistics, the image that is restored.
constexpr double kClampMemory = 70, kEnergyMemory = 16;

struct StageOptions {
  bool clamp = false;
  EnergyStage energy = EnergyStage::kOff;
};

OptionTable<StageOptions> stage_option_table() {
  return {
      switch_option("clamp", &StageOptions::clamp,
                    "samples far above what those around them allow are scaled down before"),
      choice_option<StageOptions, EnergyStage>(
          "energy", &StageOptions::energy, {{"off", EnergyStage::kOff}, {"box", EnergyStage::kBox}},
          "box: the image gets the energy of the samples' mean, where it costs the least")};
}

// The options of the stage that the filter does not have itself.
OptionTable<StageOptions> table_beside(const Filter& filter) {
  OptionTable<StageOptions> table = stage_option_table();
  for (const OptionDescription& own : filter.describe(""))
    std::erase_if(table,
                  [&](const Option<StageOptions>& option) { return option.name == own.name; });
  return table;
}

Result<Reconstruction> run_stage(const FilterFunction& filter, const StageOptions& options,
                                 const Selection& selection, const SamplePool& pool,
                                 const FilterContext& context) {
  GuardCounts guards;
  FilterContext inner = context;
  if (options.energy == EnergyStage::kBox) inner.footprints = nullptr;  // its image is not the last
  Result<Reconstruction> result = [&] {
    if (!options.clamp) return filter(selection, pool, inner);
    const ClampedSamples clamped = clamp_samples(selection, pool, {}, guards);
    return filter(clamped.selection, clamped.pool, inner);
  }();
  if (!result) return result;
  if (options.energy == EnergyStage::kBox) {
    GuardCounts counted_by_the_filter;
    const RgbImage mean = pixel_means(selection.statistics, counted_by_the_filter);
    if (!result->image[0].same_size(mean[0])) return result;  // the caller reports it
    result->image =
        restore_energy(std::move(result->image), mean,
                       scene_luminance(selection.statistics, counted_by_the_filter), {}, guards);
  }
  result->guards += guards;
  return result;
}

}  // namespace

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
    if (!options.clamp && options.energy == EnergyStage::kOff) return ready;
    ready.needs.signal = ready.needs.variance = true;
    if (options.clamp) ready.memory.per_pixel += kClampMemory;
    if (options.energy == EnergyStage::kBox) ready.memory.per_pixel += kEnergyMemory;
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
