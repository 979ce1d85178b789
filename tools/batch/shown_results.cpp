#include "tools/batch/shown_results.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

bool has_ends(const Interval& interval) {
  return std::isfinite(interval.low) && std::isfinite(interval.high);
}

}  // namespace

bool is_described_sampler(const RankedResult& result) {
  return is_by_description(known_samplers(), result.result->sampler_name);
}

bool is_described_filter(const RankedResult& result) {
  return is_by_description(known_filters(), result.result->filter_name);
}

std::string shown_scene(const std::string& recording, const std::string& group) {
  return group.empty() ? std::filesystem::path(recording).stem().string() : group;
}

std::string shown_scene(const StudyPlace& place) {
  return shown_scene(place.recording, place.group);
}

std::string shown_sampler(const RankedResult& result) {
  return result.result->methods.sampler + (is_described_sampler(result) ? kByDescriptionMark : "");
}

std::string shown_filter(const RankedResult& result) {
  return result.result->methods.filter + (is_described_filter(result) ? kByDescriptionMark : "");
}

std::string shown_method(const RankedResult& result) {
  return shown_sampler(result) + " + " + shown_filter(result);
}

double mean_or(const Interval& interval, double other) {
  return std::isfinite(interval.mean) ? interval.mean : other;
}

namespace {

// A ratio that is not 1 does not read 1, which would not agree with the verdict beside it: it has
// more digits than asked for.
constexpr int kMostDigits = 6;
std::string ratio_number(double ratio, int digits) {
  std::string text = fmt::format("{:.{}g}", ratio, digits);
  while (text == "1" && ratio != 1.0 && digits < kMostDigits)
    text = fmt::format("{:.{}g}", ratio, ++digits);
  return text;
}

// " [LOW, HIGH]" in so many digits, in more where the printed mean would lie outside.
std::string ends_text(const Interval& interval, const std::string& mean, int digits,
                      bool is_ratio = false) {
  const auto number = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
  const double shown = number(mean);
  const auto end = [&](double value, bool is_low) {
    for (int more = digits;; ++more) {
      const std::string text = fmt::format("{:.{}g}", value, more);
      const bool outside = is_low ? number(text) > shown : number(text) < shown;
      const bool reads_one = is_ratio && text == "1" && value != 1.0;
      if (more == kMostDigits || !(outside || reads_one)) return text;
    }
  };
  return fmt::format(" [{}, {}]", end(interval.low, true), end(interval.high, false));
}

}  // namespace

std::string value_text(const Interval& interval, const char* format) {
  if (std::isinf(interval.mean)) return "infinite";
  if (!std::isfinite(interval.mean)) return "n/a";
  const std::string text = fmt::format(fmt::runtime(format), interval.mean);
  return has_ends(interval) ? text + ends_text(interval, text, 3) : text;
}

std::string ratio_text(const Interval& ratio, int digits, int end_digits) {
  if (!std::isfinite(ratio.mean)) return "-";
  const std::string mean = ratio_number(ratio.mean, digits);
  return has_ends(ratio) ? mean + ends_text(ratio, mean, end_digits, true) : mean;
}

std::string count_text(double count) {
  return fmt::format("{:.0f}", std::stod(fmt::format("{:.2g}", count)));
}

}  // namespace spool::tools
