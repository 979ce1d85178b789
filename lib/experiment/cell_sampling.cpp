#include "lib/experiment/cell_sampling.h"

#include <map>
#include <utility>

#include "lib/core/radical_inverse.h"
#include "lib/core/random.h"
#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/experiment/peak_memory.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/block_jump.h"
#include "lib/statistics/edge_share.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

constexpr int kBlock = 16;  // pixels: the side of the largest regions and dyadic blocks

PoolOptions pool_options(const ExperimentOptions& options, int replicate, int holdout) {
  PoolOptions pool{options.pieces_per_side, PoolOrder::kShuffled,
                   mix(options.seed, static_cast<std::uint64_t>(replicate)), holdout};
  if (options.order == ReplicateOrder::kRecorded) pool.order = PoolOrder::kRecorded;
  if (options.order == ReplicateOrder::kDisjoint) {
    pool.seed = mix(options.seed, std::uint64_t{0});
    pool.start = radical_inverse(static_cast<unsigned>(replicate));
  }
  return pool;
}

// Halves of the halves of crossfit would say nothing of the mean that is reported.
bool splits(const ExperimentOptions& options, const Cell& cell, ReferenceKind kind) {
  const bool measured =
      cell.replicate < options.halves && options.order != ReplicateOrder::kRecorded;
  return options.fresh || (measured && kind != ReferenceKind::kCrossfit);
}

Result<void> add_halves(SampledPart& part, const ReadySampler& sampler,
                        const SamplingContext& context, bool fresh) {
  const long long budget = part.sampled.log.budget;
  const SelectHalf sample = [&](const SamplePool& pool, std::size_t half) -> Result<Selection> {
    SamplingContext of_half = context;
    of_half.seed = mix(context.seed, half);
    of_half.progress = nullptr;
    SPOOL_ASSIGN(SamplingResult sampled, sampler(pool, budget, of_half));
    return std::move(sampled.selection);
  };
  SPOOL_ASSIGN(part.halves, select_halves(part.pool, budget, fresh, sample));
  return {};
}

// `other`: the half that `pool` is not, with crossfit.
Result<JudgingReference> judging_reference(ReferenceKind kind, const SamplePool& pool,
                                           const SamplePool& other, const CountImage& counts) {
  switch (kind) {
    case ReferenceKind::kIndependent:
      return independent_reference(pool.recording());
    case ReferenceKind::kHoldout:
      return holdout_reference(pool);
    case ReferenceKind::kHoldoutPair:
      return holdout_pair_reference(pool);
    case ReferenceKind::kLeaveSelectedOut:
      return leave_selected_out_reference(pool, counts);
    case ReferenceKind::kCrossfit:
      return other_half_reference(other);
    case ReferenceKind::kPool:
      return pool_reference(pool);
  }
  return fail(ErrorCode::kUsage, "unknown reference");
}

Result<SamplingContext> sampling_context(const CellWork& work, const Cell& cell,
                                         const Needs& sampler, const CellLane& lane) {
  SamplingContext context;
  context.seed = mix(work.options.seed, static_cast<std::uint64_t>(cell.replicate));
  context.progress = [&lane](double share) { lane.report(0.5 * share); };
  context.cancelled = work.cancelled;
  if (sampler.filter_in_loop) {
    SPOOL_ASSIGN(const MethodChoice in_loop, loop_choice(sampler, cell.filter));
    SPOOL_ASSIGN(const ReadyFilter filter, work.sources.filter(in_loop));
    SPOOL_TRY(check_loop_filter(cell.sampler, sampler, in_loop, filter.needs));
    context.filter = loop_filter(filter);
  }
  return context;
}

// How many pieces gave how many samples, as of a list of a whole pixel: a half of the recording
// and a quarter of a pixel have lists that are shorter by as much.
std::vector<std::pair<int, long long>> counts_of(const std::vector<SampledPart>& parts) {
  std::map<int, long long> pieces;
  for (const SampledPart& part : parts) {
    const int q = part.pool.pieces_per_side();
    const int scale = static_cast<int>(parts.size()) * q * q;
    for (const int n : part.sampled.selection.statistics.n.pixels())
      ++pieces[n * scale];
  }
  return {pieces.begin(), pieces.end()};
}

Plane luminance_of(const RgbImage& image) {
  Plane y(image[0].width(), image[0].height());
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = luminance(image[0][i], image[1][i], image[2][i]);
  return y;
}

// Where a sampling run put its samples.
SamplingDensity density_of(const std::vector<SampledPart>& parts) {
  SamplingDensity density{counts_of(parts)};
  const double share = 1.0 / static_cast<double>(parts.size());
  for (const SampledPart& part : parts) {
    const CountImage& counts = part.sampled.selection.statistics.n;
    density.block_jump += share * block_jump(counts, kBlock * part.pool.pieces_per_side());
    density.edge_share += share * edge_share(counts, luminance_of(part.reference.mean));
  }
  return density;
}

}  // namespace

Result<SamplingRun> sample_cell(const CellWork& work, const Cell& cell,
                                const Result<ReadySampler>& ready, RecordingInUse& in_use,
                                const CellLane& lane) {
  const ExperimentOptions& options = work.options;
  SPOOL_ASSIGN(const auto recording, in_use.get(cell.dump));
  if (options.order == ReplicateOrder::kRecorded && cell.replicate > 0) {
    return fail(ErrorCode::kUsage,
                "order=recorded gives every replicate the same samples: use disjoint, or one "
                "replicate");
  }
  const ReferenceKind kind = options.reference.value_or(
      default_reference_kind(recording->spp(), recording->reference().has_value()));
  const int holdout =
      withheld_samples(kind, recording->spp(), options.holdout, options.pieces_per_side);
  SPOOL_ASSIGN(SamplePool pool,
               SamplePool::create(recording, pool_options(options, cell.replicate, holdout)));
  SPOOL_ASSIGN(ReadySampler sampler, ready);
  if (options.decision_split) sampler = split_decisions(std::move(sampler));
  SPOOL_ASSIGN(const SamplingContext context, sampling_context(work, cell, sampler.needs, lane));
  if (lane.alone) reset_peak_memory();
  SamplingRun run{{}, {}, {}, kind, in_use.kurtosis()};
  std::vector<SamplePool> pools = {pool};
  if (kind == ReferenceKind::kCrossfit) pools = {pool.half(0), pool.half(1)};
  std::vector<StageTime> times;
  for (std::size_t i = 0; i < pools.size(); ++i) {
    SPOOL_ASSIGN(SamplingResult sampled,
                 timed(options.repeats, lane.cpu(), times.emplace_back(), [&] {
                   return sampler(pools[i], sample_budget(cell.spp, *recording), context);
                 }));
    SPOOL_ASSIGN(JudgingReference reference,
                 judging_reference(kind, pools[i], pools[pools.size() - 1 - i],
                                   looked_at(sampled.selection)));
    // The filters of the run share one side; the recorded reference is that of all its runs.
    reference.kept = in_use.reference_side();  // null: not worth its memory, of the run's either
    if (reference.kept && kind != ReferenceKind::kIndependent)
      reference.kept = std::make_shared<KeptSide>();
    run.parts.push_back({pools[i], std::move(sampled), std::move(reference), std::nullopt});
    if (!splits(options, cell, kind)) continue;
    const Result<void> halves = add_halves(run.parts.back(), sampler, context, options.fresh);
    // Counts of a file may be more than a half has: then the spread is that of replicates.
    if (!halves && (options.fresh || halves.error().code != ErrorCode::kData))
      return tl::unexpected<Error>(halves.error());
  }
  run.density = density_of(run.parts);
  run.time = mean_time(times);
  return run;
}

}  // namespace spool
