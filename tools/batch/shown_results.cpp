#include "tools/batch/shown_results.h"

#include <cmath>
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

std::string value_text(const Interval& interval, const char* format) {
  if (!std::isfinite(interval.mean)) return "n/a";
  std::string text = fmt::format(fmt::runtime(format), interval.mean);
  if (!has_ends(interval)) return text;
  return text + fmt::format(" [{:.3g}, {:.3g}]", interval.low, interval.high);
}

namespace {

// An end that is not 1 does not read 1: it would not agree with the verdict beside it.
std::string ratio_end(double end) {
  std::string text;
  for (int digits = 2; digits <= 6 && (text.empty() || (text == "1" && end != 1.0)); ++digits)
    text = fmt::format("{:.{}g}", end, digits);
  return text;
}

}  // namespace

std::string ratio_text(const Interval& ratio) {
  if (!std::isfinite(ratio.mean)) return "-";
  const std::string mean = fmt::format("{:.3g}", ratio.mean);
  if (!has_ends(ratio)) return mean;
  return mean + fmt::format(" [{}, {}]", ratio_end(ratio.low), ratio_end(ratio.high));
}

std::string count_text(double count) {
  return fmt::format("{:.0f}", std::stod(fmt::format("{:.2g}", count)));
}

}  // namespace spool::tools
