// Options of the multiscale sampler [LiuZheng], and its two presets: `paper`, the most literal
// reading of the text that can be defended, and `robust`, the default. docs/method.md explains the
// symbols; the code depends on the options alone, never on a preset's name.
#pragma once

#include <optional>

#include "lib/core/option_table.h"
#include "lib/methods/method.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/uniform.h"
#include "lib/statistics/contrast.h"

namespace spool {

enum class ExposureMode { kNormalise, kNone };
enum class AnalysedChannels { kLuminance, kMaxRgb, kPerChannel };  // per channel: P = max_c P_c
enum class UpdateMode {
  kExact,  // one region, then everything that it changed is recomputed
  kEpoch,  // many regions that do not overlap, then one full analysis
};
// Samples of a piece in a step of kEpoch.
enum class StepCounts {
  kPredicted,  // as many as its region would have taken in smaller steps: predicted_count()
  kOne,
};
enum class DetailNorm { kAbsolute, kRelative, kOff };  // d^2, d^2 / (f^2 + 0.01), or 0
enum class DetailIndex {
  kProducedWithLevel,  // level k looks at d_{k-1}, what is lost by going to that level
  kSameK,              // level k looks at d_k
};
// Eq 7, with c = new samples of the region per unsaturated piece.
enum class AttenuationUpdate {
  kFractional,  // w = 1 - (1 - alpha)^c, A = (1 - w) A + w F / c
  kRegion,      // A = (1 - alpha) A + alpha F where the region received samples
  kAnyTouch,    // the same wherever f_k changed at all
  kAccumulate,  // A = alpha A + F where the region received samples
  kNone,        // A = 1
};
enum class TileHalo {
  kNone,    // a tile is analysed as if it were the whole image
  kFrozen,  // its neighbours are as they were after the initial samples
};
enum class BudgetBase {
  kAdaptive,  // eq 13 divides what is left after the initial samples
  kTotal,     // eq 13 divides everything; a tile's initial samples count as spent
};
enum class ParallelOver { kRows, kTiles };  // never changes a result

struct MultiscaleOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples()
  ExposureMode exposure = ExposureMode::kNormalise;
  AnalysedChannels channels = AnalysedChannels::kLuminance;
  ContrastForm contrast = ContrastForm::kGuarded;

  PyramidOptions pyramid;  // pyramid.levels is K
  DetailIndex detail_index = DetailIndex::kProducedWithLevel;
  DetailNorm detail_norm = DetailNorm::kAbsolute;

  double alpha = 0.4;
  AttenuationUpdate attenuation = AttenuationUpdate::kFractional;

  double explore_fraction = 0.0;  // of the adaptive budget, spent uniformly before the loop
  UpdateMode update = UpdateMode::kEpoch;
  std::optional<int> epochs;  // empty: kDefaultEpochs
  StepCounts step_counts = StepCounts::kPredicted;

  ParallelOver parallel = ParallelOver::kRows;
  int tile = 0;  // pieces per side; 0: no tiles
  TileHalo tile_halo = TileHalo::kFrozen;
  BudgetBase budget_base = BudgetBase::kAdaptive;

  int levels() const { return pyramid.levels; }
};

inline constexpr int kDefaultEpochs = 32;  // docs/decisions.md, 0081
int epoch_count(const MultiscaleOptions& options);

const OptionTable<MultiscaleOptions>& multiscale_option_table();
const Presets<MultiscaleOptions>& multiscale_presets();
const std::vector<Reading>& multiscale_readings();

}  // namespace spool
