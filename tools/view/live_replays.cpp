#include "tools/view/live_replays.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "lib/methods/method_list.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/load_recording.h"
#include "lib/statistics/joined_halves.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/method_memory.h"

namespace spool::tools {
namespace {

constexpr std::size_t kMostRecordings = 2;  // open at a time
constexpr std::size_t kMostPages = 64;      // whose turns are remembered

// Planes of doubles that a selection and an image hold, generously.
std::size_t bytes_of(const LiveReplay& replay) {
  const std::size_t planes = 24 + replay.sampled.selection.attenuation.size() +
                             24 * replay.sampled.selection.halves.size();
  return replay.sampled.selection.statistics.n.size() * planes * sizeof(double);
}

std::string text_of(const ReplayKey& key) {
  return fmt::format("{} {} {} {}", key.recording, key.sampler, key.filter, key.spp);
}

// The same for all replays; that of leave_selected_out is of one, and crossfit has two replays.
std::optional<JudgingReference> shared_reference(ReferenceKind kind, const SamplePool& pool) {
  Result<JudgingReference> reference = fail(ErrorCode::kData, "none");
  if (kind == ReferenceKind::kIndependent) reference = independent_reference(pool.recording());
  if (kind == ReferenceKind::kHoldout) reference = holdout_reference(pool);
  if (kind == ReferenceKind::kHoldoutPair) reference = holdout_pair_reference(pool);
  if (kind == ReferenceKind::kPool) reference = pool_reference(pool);
  return reference ? std::optional(std::move(*reference)) : std::nullopt;
}

Result<std::shared_ptr<const OpenRecording>> open_recording(const LiveChoices& choices,
                                                            std::size_t index) {
  SPOOL_ASSIGN(const PlanDemands methods, demands_of(choices.samplers, choices.filters));
  const WorkingMemory memory = evaluation_memory(methods.samplers, methods.filters, 1);
  const SampleFilm film = film_for(methods.samplers, methods.filters, 1);
  SPOOL_ASSIGN(const auto recording,
               load_recording(choices.recordings[index].path, choices.rules, memory, film));
  const ReferenceKind kind = choices.reference.value_or(
      default_reference_kind(recording->spp(), recording->reference().has_value()));
  PoolOptions order = choices.order;
  order.holdout = withheld_samples(kind, recording->spp(), choices.holdout, order.pieces_per_side);
  SPOOL_ASSIGN(SamplePool pool, SamplePool::create(recording, order));
  std::optional<JudgingReference> reference = shared_reference(kind, pool);
  return std::make_shared<const OpenRecording>(
      OpenRecording{recording, std::move(pool), kind, std::move(reference)});
}

Result<void> check_pixel(const SamplePool& pool, int x, int y) {
  if (x >= 0 && y >= 0 && x < pool.width() && y < pool.height()) return {};
  return fail(ErrorCode::kUsage, "pixel {},{}: from 0,0 to {},{}", x, y, pool.width() - 1,
              pool.height() - 1);
}

}  // namespace

LiveReplays::LiveReplays(LiveChoices choices, std::size_t most_bytes)
    : choices_(std::move(choices)), recordings_(kMostRecordings), replays_(most_bytes) {}

Result<std::shared_ptr<const OpenRecording>> LiveReplays::open(std::size_t recording) {
  if (recording >= choices_.recordings.size()) {
    return fail(ErrorCode::kUsage, "recording {}: there are {}", recording,
                choices_.recordings.size());
  }
  const std::string key = std::to_string(recording);
  const std::lock_guard one_at_a_time(opening_);
  {
    const std::lock_guard lock(kept_);
    if (auto found = recordings_.find(key)) return found;
  }
  SPOOL_ASSIGN(auto opened, open_recording(choices_, recording));
  const std::lock_guard lock(kept_);
  recordings_.insert(key, opened, 1);
  return opened;
}

Result<ReplayMethods> LiveReplays::methods_of(const ReplayKey& key) const {
  if (key.sampler >= choices_.samplers.size() || key.filter >= choices_.filters.size()) {
    return fail(ErrorCode::kUsage, "sampler {}, filter {}: there are {} and {}", key.sampler,
                key.filter, choices_.samplers.size(), choices_.filters.size());
  }
  ReplayMethods methods{choices_.samplers[key.sampler], choices_.filters[key.filter], {}, {}};
  SPOOL_ASSIGN(methods.sampler, make_method(known_samplers(), methods.sampler_choice));
  SPOOL_ASSIGN(methods.filter, make_method(known_filters(), methods.filter_choice));
  return methods;
}

void LiveReplays::note_turn(const Turn& turn) {
  if (turn.page.empty()) return;
  const std::lock_guard lock(kept_);
  if (latest_.size() >= kMostPages && !latest_.contains(turn.page)) latest_.clear();
  long long& latest = latest_[turn.page];
  latest = std::max(latest, turn.number);
}

bool LiveReplays::superseded(const Turn& turn) {
  if (turn.page.empty()) return false;
  const std::lock_guard lock(kept_);
  const auto latest = latest_.find(turn.page);
  return latest != latest_.end() && latest->second > turn.number;
}

Result<std::shared_ptr<const LiveReplay>> LiveReplays::compute(const ReplayKey& key,
                                                               const Turn& turn,
                                                               const OpenRecording& from) {
  SPOOL_ASSIGN(const ReplayMethods methods, methods_of(key));
  const std::function<bool()> cancelled = [&] { return superseded(turn); };
  Result<SamplingResult> sampled = sample_once(methods, from.pool, key.spp, &cancelled);
  if (cancelled()) return nullptr;
  if (!sampled) return tl::unexpected<Error>(sampled.error());
  Result<Reconstruction> result = filter_once(methods, sampled->selection, from.pool);
  SPOOL_TRY(still_intact(from.recording));
  if (!result) return tl::unexpected<Error>(result.error());
  result->variance.reset();
  auto replay = std::make_shared<LiveReplay>(
      LiveReplay{std::move(*sampled), std::move(*result), std::nullopt});
  const auto judge = [&](const JudgingReference& reference) {
    replay->relmse =
        error_metrics(replay->result.image, reference, choices_.metrics)["relmse"].value;
  };
  if (from.reference) judge(*from.reference);
  if (from.kind == ReferenceKind::kLeaveSelectedOut) {
    const CountImage counts = looked_at(replay->sampled.selection);
    judge(leave_selected_out_reference(from.pool, counts));
  }
  return replay;
}

Result<std::shared_ptr<const LiveReplay>> LiveReplays::replay(const ReplayKey& key,
                                                              const Turn& turn) {
  note_turn(turn);
  SPOOL_ASSIGN(const auto opened, open(key.recording));
  const std::string name = text_of(key);
  const auto kept = [&] {
    const std::lock_guard lock(kept_);
    return replays_.find(name);
  };
  if (auto found = kept()) return found;
  const std::lock_guard one_at_a_time(working_);
  if (auto found = kept()) return found;  // made while this one waited
  if (superseded(turn)) return nullptr;
  SPOOL_ASSIGN(auto made, compute(key, turn, *opened));
  if (made == nullptr) return made;
  const std::lock_guard lock(kept_);
  replays_.insert(name, made, bytes_of(*made));
  return made;
}

Result<PixelAnswer> LiveReplays::pixel(std::size_t recording, int x, int y) {
  SPOOL_ASSIGN(const auto opened, open(recording));
  SPOOL_TRY(check_pixel(opened->pool, x, y));
  PixelAnswer answer = pixel_answer(opened->pool, x, y, 0);
  SPOOL_TRY(still_intact(opened->recording));
  return answer;
}

Result<PixelAnswer> LiveReplays::pixel(const ReplayKey& key, int x, int y) {
  SPOOL_ASSIGN(PixelAnswer answer, pixel(key.recording, x, y));
  SPOOL_ASSIGN(const auto opened, open(key.recording));
  SPOOL_ASSIGN(const ReplayMethods methods, methods_of(key));
  SPOOL_ASSIGN(const auto replayed, replay(key, {}));
  answer.taken = replayed->sampled.selection.statistics.n(x, y);
  const RgbImage& image = replayed->result.image;
  answer.image = {image[0](x, y), image[1](x, y), image[2](x, y)};
  if (!find_method(known_filters(), methods.filter_choice.name)->footprints) return answer;
  Footprints footprints({{x, y}});
  const std::lock_guard one_at_a_time(working_);
  const Result<Reconstruction> again =
      filter_once(methods, replayed->sampled.selection, opened->pool, &footprints);
  if (!again) return tl::unexpected<Error>(again.error());
  if (!footprints.told().empty()) answer.footprint = footprints.told()[0];
  return answer;
}

}  // namespace spool::tools
