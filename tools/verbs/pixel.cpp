#include "tools/verbs/pixel.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

#include <nlohmann/json.hpp>

#include "lib/core/random.h"
#include "lib/pool/load_recording.h"
#include "tools/methods/method_memory.h"
#include "tools/terminal/json_text.h"
#include "tools/verbs/one_replay.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/pixel_answer.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

struct Place {
  int x = 0, y = 0;
};

std::vector<std::string> list_of_one(const std::string& name) {
  return name.empty() ? std::vector<std::string>{} : std::vector<std::string>{name};
}

Result<Place> parse_place(const std::string& text, const SamplePool& pool) {
  Place place;
  const std::vector<std::string> parts = split_list(text);
  bool good = parts.size() == 2;
  const std::array<int*, 2> ends = {&place.x, &place.y};
  for (std::size_t i = 0; good && i < 2; ++i) {
    const char* end = parts[i].data() + parts[i].size();
    const auto parsed = std::from_chars(parts[i].data(), end, *ends[i]);
    good = parsed.ec == std::errc() && parsed.ptr == end && *ends[i] >= 0;
  }
  if (!good || place.x >= pool.width() || place.y >= pool.height()) {
    return fail(ErrorCode::kUsage, "--at {}: write X,Y, from 0,0 to {},{}", text, pool.width() - 1,
                pool.height() - 1);
  }
  return place;
}

void print_pixel(const ordered_json& pixel) {
  const std::string taken = pixel.contains("taken")
                                ? fmt::format(", {} took {}", pixel["sampler"].get<std::string>(),
                                              pixel["taken"].get<int>())
                                : "";
  print_line(fmt::format("pixel {},{}: {} samples to take{}", pixel["x"].get<int>(),
                         pixel["y"].get<int>(), pixel["capacity"].get<int>(), taken));
  std::vector<std::vector<std::string>> rows = {
      {"take", "recorded", "R", "G", "B", "mean luminance", "95 % from", "to"}};
  const auto number = [](const ordered_json& value) {
    return value.is_number() && std::isfinite(value.get<double>())
               ? fmt::format("{:.5g}", value.get<double>())
               : std::string("-");
  };
  for (std::size_t i = 0; i < pixel["samples"].size(); ++i) {
    const ordered_json& sample = pixel["samples"][i];
    rows.push_back({std::to_string(i + 1), std::to_string(pixel["recorded"][i].get<int>()),
                    number(sample[0]), number(sample[1]), number(sample[2]),
                    number(pixel["mean"][i]), number(pixel["low"][i]), number(pixel["high"][i])});
  }
  print(format_columns(rows, 0));
}

// The largest weights, and how they lie around the pixel.
void print_footprint(const ordered_json& pixel) {
  const ordered_json& told = pixel["footprint"];
  if (told.is_null()) {
    print_line("footprint: this filter does not say its weights");
    return;
  }
  for (const ordered_json& shape : told["shapes"]) {
    std::string widths;
    for (const ordered_json& width : shape["widths"])
      widths +=
          fmt::format(" {:.4g} at {:.4g} degrees;", width[1].get<double>(), width[0].get<double>());
    const double direction = shape["direction"].get<double>();
    print_line(
        fmt::format("footprint: size {}, direction {}{}{}", shape["size"].get<int>(),
                    std::isnan(direction) ? "none" : fmt::format("{:.4g} degrees", direction),
                    widths.empty() ? "" : ", widths", widths));
  }
  std::vector<ordered_json> taps = told["taps"].get<std::vector<ordered_json>>();
  std::ranges::stable_sort(taps, [](const ordered_json& a, const ordered_json& b) {
    return std::abs(a[2].get<double>()) > std::abs(b[2].get<double>());
  });
  constexpr std::size_t kMostShown = 25;
  std::vector<std::vector<std::string>> rows = {{"dx", "dy", "weight", "R", "G", "B"}};
  for (std::size_t i = 0; i < std::min(taps.size(), kMostShown); ++i) {
    const ordered_json& tap = taps[i];
    rows.push_back({fmt::format("{:+d}", tap[0].get<int>() - pixel["x"].get<int>()),
                    fmt::format("{:+d}", tap[1].get<int>() - pixel["y"].get<int>()),
                    fmt::format("{:.4g}", tap[2].get<double>())});
    for (std::size_t c = 3; c < 6; ++c)
      rows.back().push_back(fmt::format("{:.5g}", tap[c].get<double>()));
  }
  print(format_columns(rows, 0));
  if (taps.size() > kMostShown)
    print_line(fmt::format("and {} smaller weights: --json has all", taps.size() - kMostShown));
}

// How many samples a sampler took of each pixel, and what a filter made of them.
Result<void> add_replay(const PixelOptions& options, const ReplayMethods& methods,
                        const SamplePool& pool, ordered_json& pixels) {
  SPOOL_ASSIGN(const SamplingResult sampled, sample_once(methods, pool, options.spp));
  std::vector<std::pair<int, int>> places;
  for (ordered_json& pixel : pixels) {
    places.emplace_back(pixel["x"].get<int>(), pixel["y"].get<int>());
    pixel["sampler"] = options.sampler;
    pixel["taken"] = sampled.selection.statistics.n(places.back().first, places.back().second);
  }
  if (options.filter.empty()) return {};
  Footprints footprints(places);
  SPOOL_ASSIGN(const Reconstruction result,
               filter_once(methods, sampled.selection, pool, &footprints));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [x, y] = places[i];
    pixels[i]["filter"] = options.filter;
    pixels[i]["image"] = {result.image[0](x, y), result.image[1](x, y), result.image[2](x, y)};
    pixels[i]["footprint"] =
        footprints.told().empty() ? ordered_json() : footprint_answer(footprints.told()[i]);
  }
  return {};
}

Result<ReplayMethods> replay_methods(const PixelOptions& options, Methods& methods) {
  ReplayMethods replay;
  if (!methods.samplers.empty()) {
    replay.sampler_choice = methods.samplers[0].choice;
    replay.sampler = methods.samplers[0].ready;
  }
  if (!methods.filters.empty()) {
    replay.filter_choice = methods.filters[0].choice;
    replay.filter = methods.filters[0].ready;
  }
  if (!options.filter.empty() && options.sampler.empty()) {
    return fail(ErrorCode::kUsage, "--filter {}: say with --sampler and --spp which samples",
                options.filter);
  }
  if (options.sampler.empty() != (options.spp == 0.0)) {
    return fail(ErrorCode::kUsage, "--sampler and --spp go together: give both, or none");
  }
  return replay;
}

}  // namespace

Result<void> validate(const PixelOptions& options) {
  if (options.samples != 0) SPOOL_TRY(check_bounds("samples", options.samples, kSamples));
  if (!options.sampler.empty()) SPOOL_TRY(check_bounds("spp", options.spp, kBudget));
  if (options.evaluation_seed) SPOOL_TRY(check_seed(*options.evaluation_seed));
  return validate(options.pool);
}

Result<void> run_pixel(const PixelOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  PoolOptions order = options.pool;
  if (options.evaluation_seed) {
    order.order = PoolOrder::kShuffled;
    order.seed = mix(*options.evaluation_seed, std::uint64_t{0});
  }
  SPOOL_ASSIGN(Methods methods, choose_methods(list_of_one(options.sampler),
                                               list_of_one(options.filter), options.method));
  SPOOL_ASSIGN(const ReplayMethods replay, replay_methods(options, methods));
  const auto samplers = demands_of(methods.samplers), filters = demands_of(methods.filters);
  WorkingMemory memory;
  if (!samplers.empty()) memory = evaluation_memory(samplers, filters, 1);
  SPOOL_ASSIGN(const auto recording,
               load_recording(options.dump, methods.rules, memory, film_for(samplers, filters, 1)));
  SPOOL_ASSIGN(const SamplePool pool, SamplePool::create(recording, order));
  ordered_json pixels = ordered_json::array();
  for (const std::string& text : options.places) {
    SPOOL_ASSIGN(const Place place, parse_place(text, pool));
    pixels.push_back(pixel_answer(pool, place.x, place.y, options.samples));
  }
  if (!options.sampler.empty()) SPOOL_TRY(add_replay(options, replay, pool, pixels));
  SPOOL_TRY(still_intact(recording));
  if (common.json) {
    print(json_text(pixels));
    return {};
  }
  for (const ordered_json& pixel : pixels) {
    print_pixel(pixel);
    if (pixel.contains("footprint")) print_footprint(pixel);
  }
  return {};
}

}  // namespace spool::tools
