#include "tools/batch/summary_notes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/spool_reader.h"
#include "lib/core/counted.h"
#include "lib/core/visible_text.h"
#include "tools/batch/dump_meta.h"
#include "tools/terminal/console.h"

namespace spool::tools {
namespace {

struct ShownMetric {
  const char* name;
  const char* shown;
  const RankedFinding* RankedResult::* rank;
};
constexpr std::array<ShownMetric, 2> kShownMetrics = {
    {{"relmse", "relMSE", &RankedResult::relmse}, {"mse", "MSE", &RankedResult::mse}}};

// The result whose error stands on the fewest pixels.
struct Fewest {
  const RankedResult* result = nullptr;
  const ShownMetric* metric = nullptr;
  double pixels = std::numeric_limits<double>::infinity();  // that bear half of it
  double share = 0;  // of it in the worst 0.1 % of the pixels

  void take(const RankedResult& of, const ShownMetric& by) {
    constexpr double kRemarked = 0.2;
    const std::string name = by.name;
    const double worst = mean_or(of.quantity(name + "_worst_share"), 0.0);
    const double half = mean_or(of.quantity(name + "_half_pixels"), pixels);
    if (worst < kRemarked || half >= pixels) return;
    *this = {&of, &by, half, worst};
  }
};

std::string fewest_text(const Fewest& fewest) {
  if (!fewest.result) return "";
  const StudyPlace& place = fewest.result->place();
  const auto pixels = static_cast<std::uint64_t>(std::lround(std::max(1.0, fewest.pixels)));
  return fmt::format(
      "Few pixels: {} half of the {} of {} ({}, {:g} spp), the worst 0.1 % {:.0f} %.\n",
      counted(pixels, "pixel bears", "pixels bear"), fewest.metric->shown,
      visible_text(shown_method(*fewest.result)), visible_text(shown_scene(place)), place.spp,
      100.0 * fewest.share);
}

// The methods with the largest shares.
std::string worst_text(const char* what, const std::map<std::string, double>& worst) {
  constexpr std::size_t kMost = 3;
  if (worst.empty()) return "";
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [method, share] : worst)
    order.emplace_back(-share, method);
  std::ranges::sort(order);
  std::vector<std::string> parts;
  for (const auto& [share, method] : order) {
    if (parts.size() < kMost)
      parts.push_back(fmt::format("{} (up to {:.1f} %)", visible_text(method), -100.0 * share));
  }
  if (order.size() > kMost) parts.push_back(fmt::format("{} more", order.size() - kMost));
  return fmt::format("{} by more than 2 % beyond the interval: {}.\n", what,
                     fmt::join(parts, ", "));
}

// One that cannot be read here was judged elsewhere.
bool has_import_remarks(const std::string& recording) {
  const auto reader = format::SpoolReader::open(recording);
  return reader && merged_meta(*reader).contains("import_remarks");
}

}  // namespace

std::string would_decide_text(const ShownResults& shown) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<double, std::string>> found;
  std::set<std::string> named;
  for (const RankedResult& result : shown) {
    if (!result.relmse || !result.relmse->would_decide) continue;
    const WouldDecide& more = *result.relmse->would_decide;
    std::string text =
        fmt::format("{} {} for {} ({}, {:g} spp)", count_text(more.count), more.unit(),
                    shown_method(result), shown_scene(result.place()), result.place().spp);
    if (!named.insert(text).second) continue;  // errors are the same for any number of threads
    found.emplace_back(more.recordings ? 1e6 + more.count : more.count, std::move(text));
  }
  if (found.empty()) return "";
  std::ranges::stable_sort(found, {}, &std::pair<double, std::string>::first);
  std::string text = "Would decide what is undecided, about: ";
  for (std::size_t i = 0; i < std::min(found.size(), kMost); ++i)
    text += (i > 0 ? "; " : "") + visible_text(found[i].second);
  if (found.size() > kMost)
    text += fmt::format("; {} more in statistics.json", found.size() - kMost);
  return text + ".\n";
}

std::string support_text(const ShownResults& shown, bool wide) {
  std::map<std::pair<std::string, std::string>, std::pair<int, Withheld>> withheld;
  Fewest fewest;
  for (const RankedResult& result : shown) {
    for (const ShownMetric& metric : kShownMetrics) {
      if (!wide && metric.rank != &RankedResult::relmse) continue;
      const RankedFinding* ranked = result.*metric.rank;
      if (ranked && ranked->withheld != Withheld::kNo) {
        auto& [count, why] = withheld[{metric.shown, std::string(withheld_name(ranked->withheld))}];
        ++count;
        why = ranked->withheld;
      }
      fewest.take(result, metric);
    }
  }
  std::string text = fewest_text(fewest);
  for (const auto& [name, found] : withheld) {
    const auto& [count, why] = found;
    text += fmt::format("No verdict on {} ({}): {}: {}.\n", name.first, name.second,
                        counted(static_cast<std::uint64_t>(count), "result"), withheld_remedy(why));
  }
  return text;
}

std::string light_text(const ShownResults& shown) {
  constexpr double kGain = 0.02;  // as of losses
  std::map<std::string, double> lost, gained;
  for (const RankedResult& result : shown) {
    if (!result.relmse) continue;
    const auto note = [&](std::map<std::string, double>& worst, double share) {
      double& most = worst[shown_method(result)];
      most = std::max(most, share);
    };
    if (result.relmse->loses_energy) note(lost, *result.relmse->loses_energy);
    const Interval& energy = result.relmse->energy;
    if (energy.low > 1.0 + kGain) note(gained, energy.mean - 1.0);
  }
  return worst_text("Light is lost", lost) + worst_text("Light is gained", gained);
}

std::string exchange_text(const ShownResults& shown) {
  double most = 0.0;
  const RankedResult* slowest = nullptr;
  for (const RankedResult& result : shown) {
    const double exchange = mean_or(result.quantity("seconds_exchange"), 0.0);
    if (!(exchange > most)) continue;
    most = exchange;
    slowest = &result;
  }
  if (!slowest) return "";
  const double all = mean_or(slowest->quantity("seconds_sampling"), 0.0) +
                     mean_or(slowest->quantity("seconds_filtering"), 0.0);
  return fmt::format("Commands: {} takes {}, {} of it to start and for files (seconds_exchange).\n",
                     visible_text(shown_method(*slowest)), format_seconds(all),
                     format_seconds(most));
}

std::string imported_text(const Study& study) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> found;
  for (const PlanScene& scene : study.scenes) {
    for (const std::string& recording : scene.recordings) {
      if (has_import_remarks(recording)) found.push_back(visible_text(recording));
    }
  }
  if (found.empty()) return "";
  std::string more;
  if (found.size() > kMost) {
    more = fmt::format(", {} more", found.size() - kMost);
    found.resize(kMost);
  }
  return fmt::format("With remarks from import (spool info FILE shows them): {}{}.\n",
                     fmt::join(found, ", "), more);
}

}  // namespace spool::tools
