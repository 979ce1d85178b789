#include "tools/pixel_verb.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

#include <nlohmann/json.hpp>

#include "lib/core/random.h"
#include "lib/inference/student.h"
#include "lib/pool/load_recording.h"
#include "tools/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

struct Place {
  int x = 0, y = 0;
};

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

struct Running {
  std::vector<double> mean, low, high;  // of the luminance of the first 1, 2, ... samples
};

// The interval is Student's of the samples as they are; of one sample there is none.
Running running_mean(const std::vector<double>& values) {
  Running running;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double n = static_cast<double>(i + 1), delta = values[i] - mean;
    mean += delta / n;
    squares += delta * (values[i] - mean);
    const double half =
        i == 0 ? NAN : student_quantile(0.975, n - 1.0) * std::sqrt(squares / (n - 1.0) / n);
    running.mean.push_back(mean);
    running.low.push_back(mean - half);
    running.high.push_back(mean + half);
  }
  return running;
}

// Of the positive values on a logarithmic axis; the others are counted apart.
ordered_json histogram(const std::vector<double>& values) {
  constexpr int kBins = 24;
  std::vector<double> positive;
  std::ranges::copy_if(values, std::back_inserter(positive),
                       [](double v) { return v > 0.0 && std::isfinite(v); });
  ordered_json result = {{"not_positive", values.size() - positive.size()},
                         {"edges", ordered_json::array()},
                         {"counts", ordered_json::array()}};
  if (positive.empty()) return result;
  const auto [low, high] = std::ranges::minmax(positive);
  const double first = std::log10(low);
  const double step = std::max((std::log10(high) - first) / kBins, 1e-3);  // of equal values, too
  std::vector<int> counts(kBins);
  for (const double v : positive)
    ++counts[static_cast<std::size_t>(
        std::clamp(static_cast<int>((std::log10(v) - first) / step), 0, kBins - 1))];
  for (int b = 0; b <= kBins; ++b)
    result["edges"].push_back(std::pow(10.0, first + b * step));
  result["counts"] = counts;
  return result;
}

ordered_json describe_pixel(const SamplePool& pool, Place place, int most) {
  const int capacity = pool.capacity(place.x, place.y);
  const int count = most > 0 ? std::min(most, capacity) : capacity;
  ordered_json pixel = {{"x", place.x}, {"y", place.y}, {"capacity", capacity}};
  std::vector<int> recorded;
  std::vector<std::array<float, 3>> samples;
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const Rgb value = pool.sample(place.x, place.y, i);
    recorded.push_back(pool.recorded_index(place.x, place.y, i));
    samples.push_back({value[0], value[1], value[2]});
    values.push_back(luminance(value[0], value[1], value[2]));
  }
  Running running = running_mean(values);
  pixel["recorded"] = recorded;
  pixel["samples"] = samples;
  pixel["mean"] = running.mean;
  pixel["low"] = running.low;
  pixel["high"] = running.high;
  pixel["histogram"] = histogram(values);
  return pixel;
}

void print_pixel(const ordered_json& pixel) {
  print_line(fmt::format("pixel {},{}: {} samples to take", pixel["x"].get<int>(),
                         pixel["y"].get<int>(), pixel["capacity"].get<int>()));
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

}  // namespace

Result<void> run_pixel(const PixelOptions& options, const CommonOptions& common) {
  PoolOptions order = options.pool;
  if (options.evaluation_seed) {
    order.order = PoolOrder::kShuffled;
    order.seed = mix(*options.evaluation_seed, std::uint64_t{0});
  }
  SPOOL_ASSIGN(const auto recording, load_recording(options.dump, {}, {}, SampleFilm::kLeaveOut));
  SPOOL_ASSIGN(const SamplePool pool, SamplePool::create(recording, order));
  ordered_json pixels = ordered_json::array();
  for (const std::string& text : options.places) {
    SPOOL_ASSIGN(const Place place, parse_place(text, pool));
    pixels.push_back(describe_pixel(pool, place, options.samples));
  }
  SPOOL_TRY(still_intact(recording));
  if (common.json) {
    print(json_text(pixels));
    return {};
  }
  for (const ordered_json& pixel : pixels)
    print_pixel(pixel);
  return {};
}

}  // namespace spool::tools
