#include "tools/view/live_answers.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "lib/core/visible_text.h"
#include "lib/image_io/picture.h"
#include "lib/statistics/piece_statistics.h"
#include "tools/json/json_text.h"
#include "tools/json/pixel_json.h"
#include "tools/show/plane_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

// A number of a request; kUsage where it is none.
template <class Number>
Result<Number> number_of(const Query& query, std::string_view name) {
  const std::string text = query(name);
  Number value{};
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec == std::errc() && parsed.ptr == end) return value;
  return fail(ErrorCode::kUsage, "{} '{}': is no number", name, text.substr(0, 40));
}

Result<ReplayKey> key_of(const Query& query) {
  ReplayKey key;
  SPOOL_ASSIGN(key.recording, number_of<std::size_t>(query, "recording"));
  SPOOL_ASSIGN(key.sampler, number_of<std::size_t>(query, "sampler"));
  SPOOL_ASSIGN(key.filter, number_of<std::size_t>(query, "filter"));
  SPOOL_ASSIGN(key.spp, number_of<double>(query, "spp"));
  if (key.spp >= 1e-3 && key.spp <= 65536.0) return key;
  return fail(ErrorCode::kUsage, "spp {}: from 0.001 to 65536", key.spp);
}

Turn turn_of(const Query& query) {
  Turn turn{query("page").substr(0, 40), 0};
  const Result<long long> number = number_of<long long>(query, "turn");
  if (!number) return {};
  turn.number = *number;
  return turn;
}

Answer answer_of(const Error& error) {
  return {error.code == ErrorCode::kUsage ? 400 : 422, "application/json",
          json_text({{"error", visible_text(error.message)}})};
}
Answer plane_answer(const PlaneText& planes) {
  return {200, "application/octet-stream", planes.text()};
}

Answer replay_answer(LiveReplays& replays, const Query& query) {
  const Result<ReplayKey> key = key_of(query);
  if (!key) return answer_of(key.error());
  const auto replayed = replays.replay(*key, turn_of(query));
  if (!replayed) return answer_of(replayed.error());
  if (*replayed == nullptr) return {409, "application/json", json_text({{"error", "superseded"}})};
  const LiveReplay& replay = **replayed;
  const auto opened = replays.open(key->recording);
  if (!opened) return answer_of(opened.error());
  const RgbImage& image = replay.result.image;
  PlaneText planes(image[0].width(), image[0].height());
  planes.say("spent", replay.sampled.log.spent);
  if (replay.relmse && std::isfinite(*replay.relmse)) planes.say("relmse", *replay.relmse);
  planes.add("estimate", image);
  planes.add("density", replay.sampled.selection.statistics.n);
  if ((*opened)->reference) {
    planes.add("squared_error", squared_error_map(image, *(*opened)->reference));
  }
  if (replay.result.level) planes.add("filter_size", *replay.result.level);
  if (replay.result.dominant_direction) planes.add("direction", *replay.result.dominant_direction);
  return plane_answer(planes);
}

Answer reference_answer(LiveReplays& replays, const Query& query) {
  const Result<std::size_t> index = number_of<std::size_t>(query, "recording");
  if (!index) return answer_of(index.error());
  const auto opened = replays.open(*index);
  if (!opened) return answer_of(opened.error());
  if (!(*opened)->reference) return {404, "application/json", json_text({{"error", "none"}})};
  const RgbImage& mean = (*opened)->reference->mean;
  PlaneText planes(mean[0].width(), mean[0].height());
  planes.add("reference", mean);
  return plane_answer(planes);
}

Result<PixelAnswer> pixel_of(LiveReplays& replays, const Query& query) {
  SPOOL_ASSIGN(const int x, number_of<int>(query, "x"));
  SPOOL_ASSIGN(const int y, number_of<int>(query, "y"));
  if (query("sampler").empty()) {
    SPOOL_ASSIGN(const std::size_t recording, number_of<std::size_t>(query, "recording"));
    return replays.pixel(recording, x, y);
  }
  SPOOL_ASSIGN(const ReplayKey key, key_of(query));
  return replays.pixel(key, x, y);
}

// Of the first four samples: enough to choose an exposure by.
RgbImage first_means(const SamplePool& pool) {
  PieceStatistics statistics = empty_statistics(pool);
  take_everywhere(statistics, pool, 4);
  return statistics.mean;
}

// EV that brings the picture's middle to grey, in half steps, and its mean luminance.
std::pair<double, double> exposure_and_mean(const OpenRecording& opened) {
  const RgbImage guide = opened.reference ? opened.reference->mean : first_means(opened.pool);
  double sum = 0.0;
  for (std::size_t i = 0; i < guide[0].size(); ++i) {
    const double y = luminance(guide[0][i], guide[1][i], guide[2][i]);
    sum += std::isfinite(y) ? y : 0.0;
  }
  const double mean = sum / static_cast<double>(guide[0].size());
  const double exposure = std::log2(tone_exposure(guide));
  return {std::isfinite(exposure) ? std::round(2.0 * exposure) / 2.0 : 0.0,
          mean > 0.0 ? mean : 1.0};
}

// To a pixel: those held out are not.
long long samples_offered(const SamplePool& pool) {
  return pool.total_capacity() / (static_cast<long long>(pool.width()) * pool.height());
}

// A recording that cannot be opened has no size: the page says why.
ordered_json described(LiveReplays& replays, std::size_t index) {
  ordered_json told = {{"label", visible_text(replays.choices().recordings[index].label)}};
  const auto opened = replays.open(index);
  if (!opened) {
    told["error"] = visible_text(opened.error().message);
    return told;
  }
  const auto [exposure, mean] = exposure_and_mean(**opened);
  told.update({{"width", (*opened)->pool.width()},
               {"height", (*opened)->pool.height()},
               {"spp", samples_offered((*opened)->pool)},
               {"exposure", exposure},
               {"mean", mean},
               {"reference", (*opened)->reference.has_value()}});
  return told;
}

Answer choices_answer(LiveReplays& replays) {
  ordered_json told = {{"recordings", ordered_json::array()},
                       {"samplers", ordered_json::array()},
                       {"filters", ordered_json::array()},
                       {"left_out", visible_text(replays.choices().left_out)}};
  for (std::size_t i = 0; i < replays.choices().recordings.size(); ++i)
    told["recordings"].push_back(described(replays, i));
  for (const MethodChoice& sampler : replays.choices().samplers)
    told["samplers"].push_back(visible_text(sampler.label()));
  for (const MethodChoice& filter : replays.choices().filters)
    told["filters"].push_back(visible_text(filter.label()));
  return {200, "application/json", json_text(told)};
}

}  // namespace

Answers live_answers(const std::shared_ptr<LiveReplays>& replays) {
  return {
      {"choices", [replays](const Query&) { return choices_answer(*replays); }},
      {"replay", [replays](const Query& query) { return replay_answer(*replays, query); }},
      {"reference", [replays](const Query& query) { return reference_answer(*replays, query); }},
      {"pixel", [replays](const Query& query) {
         const Result<PixelAnswer> pixel = pixel_of(*replays, query);
         return pixel ? Answer{200, "application/json", pixel_text(*pixel)}
                      : answer_of(pixel.error());
       }}};
}

}  // namespace spool::tools
