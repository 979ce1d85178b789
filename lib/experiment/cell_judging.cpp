#include "lib/experiment/cell_judging.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "lib/experiment/decision_split.h"
#include "lib/experiment/peak_memory.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

ErrorSupport mean_support(const ErrorSupport& a, const ErrorSupport& b) {
  return {0.5 * (a.worst_share + b.worst_share), 0.5 * (a.half_pixels + b.half_pixels),
          0.5 * (a.reference_noise + b.reference_noise)};
}

// The mean of two tables of one size, for the two halves of crossfit; guards and pixels are sums.
MetricTable mean_table(MetricTable a, const MetricTable& b) {
  for (std::size_t m = 0; m < a.values.size(); ++m) {
    a.values[m].value = 0.5 * (a.values[m].value + b.values[m].value);
    std::vector<double>& resampled = a.resampled[m];
    resampled.resize(std::min(resampled.size(), b.resampled[m].size()));
    for (std::size_t s = 0; s < resampled.size(); ++s)
      resampled[s] = 0.5 * (resampled[s] + b.resampled[m][s]);
    a.values[m].standard_error = standard_error_of(resampled);
  }
  a.squared = mean_support(a.squared, b.squared);
  a.relative = mean_support(a.relative, b.relative);
  a.relative_scale = 0.5 * (a.relative_scale + b.relative_scale);
  a.pixels += b.pixels;
  a.excluded_estimate += b.excluded_estimate;
  a.excluded_reference += b.excluded_reference;
  a.failed = a.failed || b.failed;
  a.guards += b.guards;
  return a;
}

Result<void> judge_split(const MetricOptions& metrics, const SamplingRun& run,
                         const ReadyFilter& filter, FilterContext context, CellResult& result) {
  context.progress = nullptr;
  std::vector<FreshErrors> fresh;
  for (const SampledPart& part : run.parts) {
    if (!part.halves) return {};
    const bool left_out = run.kind == ReferenceKind::kLeaveSelectedOut;
    SPOOL_ASSIGN(
        HalfErrors errors,
        judge_halves(
            part.pool, *part.halves, part.sampled.selection.statistics.n,
            left_out ? leave_selected_out_reference(part.pool, looked_at(part.pool, *part.halves))
                     : part.reference,
            metrics, [&](const Selection& selection, const SamplePool& half) -> Result<RgbImage> {
              SPOOL_ASSIGN(Reconstruction image, filter(selection, half, context));
              return std::move(image.image);
            }));
    if (errors.fresh) fresh.push_back(*errors.fresh);
    if (run.parts.size() == 1) result.halves = std::move(errors.differences);
  }
  if (!fresh.empty()) result.fresh = mean_of(fresh);
  return {};
}

Result<void> check_size(const RgbImage& image, const RecordedSamples& recording, const Cell& cell) {
  if (image[0].width() == recording.width() && image[0].height() == recording.height()) return {};
  return fail(ErrorCode::kData, "{}: the filter returned {} x {} pixels for a recording of {} x {}",
              cell.filter.label(), image[0].width(), image[0].height(), recording.width(),
              recording.height());
}

Result<void> add_masks(const ExperimentOptions& options, const std::vector<Reconstruction>& images,
                       const SamplingRun& run, CellResult& result) {
  const std::string recording = std::filesystem::path(result.cell.dump).filename().string();
  for (const EnergyMask& mask : options.masks) {
    if (!mask.recording.empty() && mask.recording != recording) continue;
    MetricValue mean{0.0, 0.0};
    for (std::size_t i = 0; i < images.size(); ++i) {
      SPOOL_ASSIGN(const MetricValue ratio,
                   energy_in_mask(images[i].image, run.parts[i].reference.mean, mask,
                                  options.metrics.bootstrap));
      mean.value += ratio.value / static_cast<double>(images.size());
      mean.standard_error += ratio.standard_error / static_cast<double>(images.size());
    }
    result.masks.emplace_back(mask.name, mean);
  }
  return {};
}

// The image of each part of the run.
Result<std::vector<Reconstruction>> filtered(const CellWork& work, const SamplingRun& run,
                                             const CellLane& lane, const ReadyFilter& filter,
                                             const FilterContext& context, CellResult& result) {
  std::vector<Reconstruction> images;
  std::vector<StageTime> times;
  for (const SampledPart& part : run.parts) {
    SPOOL_ASSIGN(Reconstruction image,
                 timed(work.options.repeats, lane.cpu(), times.emplace_back(),
                       [&] { return filter(part.sampled.selection, part.pool, context); }));
    SPOOL_TRY(check_size(image.image, part.pool.recording(), result.cell));
    images.push_back(std::move(image));
  }
  result.filtering = mean_time(times);
  return images;
}

// What is known of the run and its recording.
void add_facts(const SamplingRun& run, CellResult& result) {
  const SamplePool& pool = run.parts.front().pool;
  const RecordedSamples& recording = pool.recording();
  result.reference = run.kind;
  result.holdout = pool.options().holdout;
  result.width = recording.width();
  result.height = recording.height();
  result.pieces_per_side = pool.pieces_per_side();
  result.recorded_spp = recording.spp();
  result.recorded_kurtosis = run.kurtosis;
  result.density = run.density;
  result.sampling = run.time;
  result.cost_per_sample = recording.cost_per_sample();
}

void add_logs(const SamplingRun& run, const std::vector<Reconstruction>& images,
              CellResult& result) {
  result.log = run.parts.front().sampled.log;
  result.guards = run.parts.front().pool.recording().guards();
  result.guards += result.metrics.guards;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const SamplingLog& log = run.parts[i].sampled.log;
    result.exchange_seconds +=
        (images[i].exchange_seconds + log.exchange_seconds) / static_cast<double>(images.size());
    result.guards += log.guards;
    result.guards += images[i].guards;
    // Of two halves the worse one counts: it says where the recording was too short.
    result.log.spent = std::min(result.log.spent, log.spent);
    result.log.saturated_pieces = std::max(result.log.saturated_pieces, log.saturated_pieces);
  }
}

}  // namespace

Result<void> judge_cell(const CellWork& work, const SamplingRun& run, const CellLane& lane,
                        CellResult& result, const std::function<void(const CellImages&)>& shown) {
  const RecordedSamples& recording = run.parts.front().pool.recording();
  SPOOL_ASSIGN(const ReadyFilter chosen, work.sources.filter(result.cell.filter));
  const ReadyFilter filter = average_halves(chosen);
  FilterContext context;
  context.reference = recording.reference() ? &*recording.reference() : nullptr;
  context.progress = [&](double share) { lane.report(0.5 + 0.5 * share); };
  SPOOL_ASSIGN(const std::vector<Reconstruction> images,
               filtered(work, run, lane, filter, context, result));
  if (lane.alone) result.peak_memory = peak_memory();
  const StageClock clock(lane.cpu());
  const MetricOptions& metrics = work.options.metrics;
  for (std::size_t i = 0; i < images.size(); ++i) {
    MetricTable table = error_metrics(images[i].image, run.parts[i].reference, metrics);
    result.metrics = i == 0 ? std::move(table) : mean_table(std::move(result.metrics), table);
  }
  SPOOL_TRY(add_masks(work.options, images, run, result));
  result.judging = clock.elapsed();
  if (filter.needs.samples) SPOOL_TRY(judge_split(metrics, run, filter, context, result));
  add_facts(run, result);
  add_logs(run, images, result);
  const SampledPart& part = run.parts.front();
  shown({images.front().image, part.sampled.selection, images.front(), part.reference});
  return {};
}

}  // namespace spool
