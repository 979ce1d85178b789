#include "tools/verbs/pixel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "lib/core/counted.h"
#include "lib/core/random.h"
#include "lib/pool/load_recording.h"
#include "tools/json/pixel_json.h"
#include "tools/methods/method_memory.h"
#include "tools/verbs/one_replay.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/pixel_answer.h"

namespace spool::tools {
namespace {

struct Place {
  int x = 0, y = 0;
};

std::vector<std::string> list_of_one(const std::string& name) {
  return name.empty() ? std::vector<std::string>{} : std::vector<std::string>{name};
}

Result<Place> parse_place(const std::string& text, const SamplePool& pool) {
  if (const std::vector<std::string> parts = split_list(text); parts.size() == 2) {
    const auto x = parse_integer("--at", parts[0], 0, pool.width() - 1);
    const auto y = parse_integer("--at", parts[1], 0, pool.height() - 1);
    if (x && y) return Place{*x, *y};
  }
  return fail(ErrorCode::kUsage, "--at {}: write X,Y, from 0,0 to {},{}", text, pool.width() - 1,
              pool.height() - 1);
}

void print_pixel(const PixelAnswer& pixel) {
  const std::string taken =
      pixel.taken ? fmt::format(", {} took {}", pixel.sampler, *pixel.taken) : "";
  print_line(fmt::format("pixel {},{}: {} to take{}; mean of luminance", pixel.x, pixel.y,
                         counted(pixel.capacity, "sample"), taken));
  std::vector<std::vector<std::string>> rows = {
      {"take", "recorded", "R", "G", "B", "mean", "95 % from", "to"}};
  // In so few digits that lines have at most 80 characters; --json has all.
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.4g}", value) : std::string("-");
  };
  for (std::size_t i = 0; i < pixel.samples.size(); ++i) {
    const auto& [r, g, b] = pixel.samples[i];
    rows.push_back({std::to_string(i + 1), std::to_string(pixel.recorded[i]), number(r), number(g),
                    number(b), number(pixel.mean[i]), number(pixel.low[i]), number(pixel.high[i])});
  }
  print(format_columns(rows, 0));
}

void print_shape(const FootprintShape& shape) {
  std::string widths;
  for (const auto& [beta, width] : shape.widths)
    widths += fmt::format("{} {:.4g} at {:.4g} degrees", widths.empty() ? "" : ";", width, beta);
  const std::string line = fmt::format(
      "footprint: size {}, direction {}{}{}", shape.size,
      std::isnan(shape.direction) ? "none" : fmt::format("{:.4g} degrees", shape.direction),
      widths.empty() ? "" : ", widths", widths);
  print(wrapped(line, line_width(), 2) + "\n");
}

// The largest weights, and how they lie around the pixel.
void print_footprint(const PixelAnswer& pixel) {
  if (!pixel.footprint) {
    print_line("footprint: this filter returns no weights");
    return;
  }
  for (const FootprintShape& shape : pixel.footprint->shapes)
    print_shape(shape);
  std::vector<std::pair<std::pair<int, int>, FootprintTap>> taps;
  std::ranges::copy_if(pixel.footprint->taps, std::back_inserter(taps),
                       [](const auto& tap) { return tap.second.weight != 0.0; });
  std::ranges::stable_sort(taps, [](const auto& a, const auto& b) {
    return std::abs(a.second.weight) > std::abs(b.second.weight);
  });
  constexpr std::size_t kMostShown = 25;
  std::vector<std::vector<std::string>> rows = {{"dx", "dy", "weight", "R", "G", "B"}};
  for (std::size_t i = 0; i < std::min(taps.size(), kMostShown); ++i) {
    const auto& [place, tap] = taps[i];
    rows.push_back({fmt::format("{:+d}", place.second - pixel.x),
                    fmt::format("{:+d}", place.first - pixel.y),
                    fmt::format("{:.4g}", tap.weight)});
    for (const double weighted : tap.weighted)
      rows.back().push_back(fmt::format("{:.5g}", weighted / tap.weight));
  }
  print(format_columns(rows, 0));
  if (taps.size() > kMostShown)
    print_line(fmt::format("and {} smaller weights: --json has all", taps.size() - kMostShown));
}

// How many samples a sampler took of each pixel, and what a filter made of them.
Result<void> add_replay(const PixelOptions& options, const ReplayMethods& methods,
                        const SamplePool& pool, std::vector<PixelAnswer>& pixels) {
  SPOOL_ASSIGN(const SamplingResult sampled, sample_once(methods, pool, *options.spp));
  std::vector<std::pair<int, int>> places;
  for (PixelAnswer& pixel : pixels) {
    places.emplace_back(pixel.x, pixel.y);
    pixel.sampler = options.sampler;
    pixel.taken = sampled.selection.statistics.n(pixel.x, pixel.y);
  }
  if (options.filter.empty()) return {};
  Footprints footprints(places);
  SPOOL_ASSIGN(const Reconstruction result,
               filter_once(methods, sampled.selection, pool, &footprints));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [x, y] = places[i];
    pixels[i].filter = options.filter;
    pixels[i].image = {result.image[0](x, y), result.image[1](x, y), result.image[2](x, y)};
    if (!footprints.told().empty()) pixels[i].footprint = footprints.told()[i];
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
  return replay;
}

}  // namespace

Result<void> validate(const PixelOptions& options) {
  if (options.samples != 0) SPOOL_TRY(check_bounds("samples", options.samples, kSamples));
  if (options.sampler.empty() == options.spp.has_value())
    return fail(ErrorCode::kUsage, "--sampler and --spp go together: give both, or none");
  if (options.spp) SPOOL_TRY(check_bounds("spp", *options.spp, kBudget));
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
  std::vector<PixelAnswer> pixels;
  for (const std::string& text : options.places) {
    SPOOL_ASSIGN(const Place place, parse_place(text, pool));
    pixels.push_back(pixel_answer(pool, place.x, place.y, options.samples));
  }
  if (!options.sampler.empty()) SPOOL_TRY(add_replay(options, replay, pool, pixels));
  SPOOL_TRY(still_intact(recording));
  if (common.json) {
    print(pixels_text(pixels));
    return {};
  }
  for (const PixelAnswer& pixel : pixels) {
    print_pixel(pixel);
    if (pixel.image) print_footprint(pixel);
  }
  return {};
}

}  // namespace spool::tools
