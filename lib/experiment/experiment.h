// Runs cells - one recording, sampler, filter, budget and replicate each - and judges the images.
//
// Cells that differ in the filter only share one sampling run, unless the sampler needs the cell's
// filter in its loop. Where the sources say so, several sampling runs of a recording go beside each
// other, each on a thread of its own: the same bits, but times of a machine that is shared. An
// error in one cell is kept in its result; the others go on. Nothing is written here: finished
// cells and their images are handed to a callback. How methods and recordings are found is handed
// in, so that evaluation knows no method.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/experiment/cell.h"
#include "lib/experiment/fresh_samples.h"
#include "lib/experiment/reference.h"
#include "lib/experiment/stage_clock.h"
#include "lib/filters/filter.h"
#include "lib/methods/method_text.h"
#include "lib/metrics/energy_masks.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/sampler.h"

namespace spool {

// Which samples the replicates of a recording take.
enum class ReplicateOrder {
  kRecorded,  // as they were recorded: one replicate only
  kShuffled,  // every replicate shuffles the samples of each pixel anew: the same ones in part
  // One shuffled order for all, which replicate r enters at radical_inverse(r) of its length and
  // goes around: no sample is taken twice as long as the replicates fit in beside each other.
  kDisjoint
};
std::string_view order_name(ReplicateOrder order);

struct ExperimentOptions {
  std::uint64_t seed = 1;  // of replicate r: mix(seed, r), for the pool's order and the method
  ReplicateOrder order = ReplicateOrder::kDisjoint;
  int pieces_per_side = 1;
  bool decision_split = false;  // no sample decides about its own half (decision_split.h)
  bool fresh = false;  // also the counts on samples that had no part in them (fresh_samples.h)
  // Replicates whose pool is also split into two halves, to measure how much errors vary between
  // recordings; costs two more runs of the sampler and the filter each.
  int halves = 0;
  std::optional<ReferenceKind> reference;  // absent: default_reference_kind of each recording
  std::optional<int> holdout;  // samples per pixel; absent: as the reference kind requires
  int repeats = 1;             // of sampling and filtering, for their times only
  MetricOptions metrics;
  std::vector<EnergyMask> masks;  // of recordings by file name
};

// Where recordings and methods come from.
struct ExperimentSources {
  std::function<Result<std::shared_ptr<const RecordedSamples>>(const std::string&)> load;
  std::function<Result<ReadySampler>(const MethodChoice&)> sampler;
  std::function<Result<ReadyFilter>(const MethodChoice&)> filter;
  // How many sampling runs of this recording may go beside each other; absent: one. Cells that ask
  // for threads or repeats, because they measure time, run alone always.
  std::function<int(const RecordedSamples&)> runs_at_once = {};
};

// Where a sampling run put its samples; the mean of its parts.
struct SamplingDensity {
  // Samples taken (of a list as long as a pixel's) and the number of pieces that gave so many.
  std::vector<std::pair<int, long long>> counts;
  double block_jump = 0.0;  // across multiples of 16 pixels (block_jump.h)
  double edge_share = 0.0;  // edge_share.h, of the luminance of what judges
};

struct CellResult {
  Cell cell;
  std::optional<Error> error;  // present: nothing below holds
  MetricTable metrics;
  std::optional<FreshErrors> fresh;  // absent: not asked for, or a half is too short
  std::vector<MetricHalves> halves;  // empty as above, and with crossfit
  ReferenceKind reference = ReferenceKind::kIndependent;
  int holdout = 0;            // samples per pixel
  int width = 0, height = 0;  // pixels
  int pieces_per_side = 1;
  StageTime reading;   // loading the recording; 0 where an earlier cell loaded it
  StageTime sampling;  // shared by all filters of one sampling run
  StageTime filtering;
  double exchange_seconds = 0;  // of both: starting commands and handing files over, wall time
  StageTime judging;            // metrics
  StageTime writing;            // images; for the callback to fill in
  std::optional<std::uint64_t> peak_memory;  // bytes of the process while it sampled and filtered
  std::optional<double> cost_per_sample;     // seconds, as recorded
  int recorded_spp = 0;                      // samples per pixel of the recording
  double recorded_kurtosis = 0.0;            // of its samples (sample_kurtosis.h)
  SamplingDensity density;
  int threads = 0;
  bool alone = true;  // nothing else of the experiment ran meanwhile
  SamplingLog log;
  GuardCounts guards;                                      // of all stages
  std::vector<std::pair<std::string, MetricValue>> masks;  // energy ratio in each, by name
};

// What a finished cell was made of; valid during the callback only.
struct CellImages {
  const RgbImage& image;
  const Selection& selection;
  const Reconstruction& reconstruction;
  const JudgingReference& reference;
};

// No two of them are called at the same time.
struct ExperimentCallbacks {
  // After each cell, whose result is the callback's own; `images` is null when the cell failed.
  std::function<void(CellResult&, const CellImages* images)> finished;
  // Cells done (the current one in part) of all: 0 .. 1.
  std::function<void(double)> progress;
  std::function<bool()> cancelled;  // asked between cells
};

}  // namespace spool
