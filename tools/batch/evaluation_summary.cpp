#include "tools/batch/evaluation_summary.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>
#include <vector>

#include "lib/core/visible_text.h"
#include "lib/inference/withheld.h"
#include "tools/batch/claims_json.h"
#include "tools/methods/external_methods.h"
#include "tools/terminal/console.h"
#include "tools/terminal/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kLongestTable = 200;  // lines; beyond, the best of each condition
constexpr std::size_t kBestShown = 5;

using Place = std::tuple<std::string, double, int>;                  // scene, spp, threads
using Name = std::tuple<Place, std::string, std::string>;            // sampler, filter
using Ranked = std::map<std::string, std::map<Name, ordered_json>>;  // by metric

Place place_of(const ordered_json& entry) {
  return {entry["dump"], entry["spp"], entry["threads"]};
}

Name name_of(const Place& place, const ordered_json& entry) {
  return {place, entry["sampler"], entry["filter"]};
}

// "0.0123 [0.011, 0.014]"
std::string value_text(const ordered_json& interval, const char* format = "{:.4g}") {
  if (interval.empty()) return "n/a";
  std::string text = fmt::format(fmt::runtime(format), interval[0].get<double>());
  if (interval.size() < 3) return text;
  return text +
         fmt::format(" [{:.3g}, {:.3g}]", interval[1].get<double>(), interval[2].get<double>());
}

bool is_described_sampler(const ordered_json& result) {
  return is_by_description(known_samplers(), result["sampler_name"].get<std::string>());
}

bool is_described_filter(const ordered_json& result) {
  return is_by_description(known_filters(), result["filter_name"].get<std::string>());
}

ordered_json quantity(const ordered_json& result, const char* name) {
  const auto found = result.find("quantities");
  return found != result.end() && found->contains(name) ? found->at(name) : ordered_json::array();
}

double mean_or(const ordered_json& interval, double other) {
  return interval.empty() ? other : interval[0].get<double>();
}

class Summary {
 public:
  explicit Summary(const ordered_json& statistics) {
    for (const ordered_json& condition : statistics["conditions"]) {
      const Place place = place_of(condition);
      const std::string metric = condition["metric"];
      if (metric == "relmse") add_about(condition["about"]);
      biased_ = biased_ || condition["biased"].get<bool>();
      std::size_t rank = 0;
      for (const ordered_json& entry : condition["ranking"]) {
        ordered_json& kept = ranked_[metric][name_of(place, entry)] = entry;
        kept["place"] = rank++;
      }
    }
    for (const ordered_json& result : statistics["results"]) {
      if (result["replicates"] > 0) results_.push_back(&result);
      if (result["threads"] != 0) threads_ = true;
    }
    std::map<Place, std::size_t> places;
    for (const ordered_json* result : results_)
      places.try_emplace(place_of(*result), places.size());
    std::ranges::stable_sort(results_, {}, [&](const ordered_json* result) {
      return std::pair(places.at(place_of(*result)), rank_of(*result));
    });
  }

  bool empty() const { return results_.empty(); }
  bool has_threads() const { return threads_; }
  bool biased() const { return biased_; }
  const std::vector<const ordered_json*>& results() const { return results_; }
  // One of each kind: where replicates share samples, that with the most.
  std::vector<std::string> abouts() const {
    std::vector<std::string> texts;
    for (const auto& [kind, about] : abouts_)
      texts.push_back(about.second);
    return texts;
  }

  // As the ranking of the metric has it; an empty object where it has not.
  const ordered_json& ranked(const ordered_json& result, const char* metric) const {
    static const ordered_json none = ordered_json::object();
    const auto of_metric = ranked_.find(metric);
    if (of_metric == ranked_.end()) return none;
    const auto found = of_metric->second.find(name_of(place_of(result), result));
    return found == of_metric->second.end() ? none : found->second;
  }

 private:
  std::size_t rank_of(const ordered_json& result) const {
    return ranked(result, "relmse").value("place", std::size_t{1} << 40);
  }

  void add_about(const ordered_json& about) {
    auto& kept = abouts_[about["kind"].get<std::string>()];
    const auto shared = about["shared"].get<double>();
    if (kept.second.empty() || shared > kept.first)
      kept = {shared, about["text"].get<std::string>()};
  }

  Ranked ranked_;
  std::map<std::string, std::pair<double, std::string>> abouts_;  // by kind
  std::vector<const ordered_json*> results_;
  bool threads_ = false, biased_ = false;
};

// One or two digits less than value_text(): a ratio is read beside its error.
std::string ratio_text(const ordered_json& ranked) {
  const auto ratio = ranked.find("ratio");
  if (ratio == ranked.end() || ratio->empty()) return "-";
  const std::string mean = fmt::format("{:.3g}", (*ratio)[0].get<double>());
  if (ratio->size() < 3) return mean;
  return mean +
         fmt::format(" [{:.2g}, {:.2g}]", (*ratio)[1].get<double>(), (*ratio)[2].get<double>());
}

std::string verdict_text(const ordered_json& ranked) {
  if (ranked.contains("withheld") || ranked.contains("baseline_withheld")) return "no verdict";
  return ranked.value("against_baseline", std::string("-"));
}

std::string energy_text(const ordered_json& result, const ordered_json& ranked) {
  const ordered_json energy = quantity(result, "energy_ratio");
  if (energy.empty()) return "n/a";
  const std::string text = fmt::format("{:.3f}", energy[0].get<double>());
  return ranked.contains("loses_energy") ? text + " (loses)" : text;
}

std::vector<const ordered_json*> best_of_each(const std::vector<const ordered_json*>& results) {
  std::map<Place, std::size_t> taken;
  std::vector<const ordered_json*> best;
  for (const ordered_json* result : results) {
    if (++taken[place_of(*result)] <= kBestShown && best.size() < kLongestTable)
      best.push_back(result);
  }
  return best;
}

std::string shown_scene(const ordered_json& entry) {
  return std::filesystem::path(entry["dump"].get<std::string>()).stem().string();
}

std::string shown_method(const ordered_json& result) {
  return result["sampler"].get<std::string>() +
         (is_described_sampler(result) ? kByDescriptionMark : "") + " + " +
         result["filter"].get<std::string>() +
         (is_described_filter(result) ? kByDescriptionMark : "");
}

std::string shown_place(const ordered_json& result, bool threads) {
  return fmt::format("{}, {:g} samples per pixel{}", shown_scene(result),
                     result["spp"].get<double>(),
                     threads ? fmt::format(", {} threads", result["threads"].get<int>()) : "");
}

// Method, relMSE, ratio, verdict, below a heading for each scene and budget: 80 columns hold it.
std::string short_table(const Summary& summary, const std::vector<const ordered_json*>& shown,
                        const std::string& baseline) {
  std::vector<std::vector<std::string>> rows = {{"", "relMSE", "ratio", "than baseline"}};
  std::vector<std::string> headings = {""};
  for (const ordered_json* result : shown) {
    const std::string heading = shown_place(*result, summary.has_threads());
    const bool first = rows.size() == 1 || headings.back() != heading;
    const ordered_json& ranked = summary.ranked(*result, "relmse");
    const std::string name = shown_method(*result);
    rows.push_back({"  " + name, value_text(quantity(*result, "relmse"), "{:.3g}"),
                    ratio_text(ranked), name == baseline ? "(baseline)" : verdict_text(ranked)});
    headings.push_back(first ? heading : headings.back());
  }
  std::istringstream lines(format_columns(rows, 1));
  std::string text, line, last;
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    if (headings[i] != last) text += visible_text(headings[i]) + "\n";
    last = headings[i];
    text += line + "\n";
  }
  return text;
}

std::string wide_table(const Summary& summary, const std::vector<const ordered_json*>& shown) {
  std::vector<std::vector<std::string>> rows = {{"dump", "sampler", "filter", "spp", "spent",
                                                 "relMSE", "ratio", "than baseline", "MSE", "ratio",
                                                 "energy", "sampling", "filtering"}};
  if (summary.has_threads()) rows.front().emplace_back("threads");
  for (const ordered_json* result : shown) {
    const ordered_json& relmse = summary.ranked(*result, "relmse");
    rows.push_back({shown_scene(*result),
                    (*result)["sampler"].get<std::string>() +
                        (is_described_sampler(*result) ? kByDescriptionMark : ""),
                    (*result)["filter"].get<std::string>() +
                        (is_described_filter(*result) ? kByDescriptionMark : ""),
                    fmt::format("{:g}", (*result)["spp"].get<double>()),
                    fmt::format("{:.4g}", mean_or(quantity(*result, "samples_per_pixel"), 0.0)),
                    value_text(quantity(*result, "relmse")), ratio_text(relmse),
                    verdict_text(relmse), value_text(quantity(*result, "mse")),
                    ratio_text(summary.ranked(*result, "mse")), energy_text(*result, relmse),
                    format_seconds(mean_or(quantity(*result, "seconds_sampling"), 0.0)),
                    format_seconds(mean_or(quantity(*result, "seconds_filtering"), 0.0))});
    if (summary.has_threads()) {
      rows.back().push_back(std::to_string((*result)["threads"].get<int>()));
    }
  }
  return format_columns(rows, 3);
}

// relMSE in the baseline's processor time.
std::string equal_time_table(const ordered_json& statistics) {
  std::vector<std::vector<std::string>> rows = {
      {"dump", "sampler", "filter", "spp of baseline", "its CPU time", "relMSE ratio then"}};
  for (const ordered_json& curve : statistics["curves"]) {
    if (curve["metric"] != "relmse" || !curve.contains("equal_time")) continue;
    for (const ordered_json& at : curve["equal_time"]) {
      const std::string outside = at.value("outside", std::string());
      rows.push_back({shown_scene(curve), curve["sampler"], curve["filter"],
                      fmt::format("{:g}", at["at"].get<double>()),
                      at["seconds"].is_null() ? "n/a" : format_seconds(at["seconds"].get<double>()),
                      outside.empty() ? ratio_text(at) : outside});
    }
  }
  if (rows.size() == 1) return "";
  return "\nIn the processor time of the baseline (too slow, too fast: at all budgets here)\n" +
         format_columns(rows, 3);
}

// The methods that more replicates or recordings would tell from the baseline, the cheapest first.
std::string would_tell_text(const Summary& summary, const std::vector<const ordered_json*>& shown) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<double, std::string>> found;
  for (const ordered_json* result : shown) {
    const ordered_json& ranked = summary.ranked(*result, "relmse");
    const auto more = ranked.find("would_tell");
    if (more == ranked.end()) continue;
    for (const auto& [unit, number] : more->items()) {
      const auto count = number.get<double>();
      found.emplace_back(
          unit == "recordings" ? 1e6 + count : count,
          fmt::format("{:.2g} {} for {} ({}, {:g} spp)", count, unit, shown_method(*result),
                      shown_scene(*result), (*result)["spp"].get<double>()));
    }
  }
  if (found.empty()) return "";
  std::ranges::stable_sort(found, {}, &std::pair<double, std::string>::first);
  std::string text = "Would tell what is undecided, about: ";
  for (std::size_t i = 0; i < std::min(found.size(), kMost); ++i)
    text += (i > 0 ? "; " : "") + visible_text(found[i].second);
  if (found.size() > kMost)
    text += fmt::format("; {} more in statistics.json", found.size() - kMost);
  return text + ".\n";
}

const char* shown_metric(std::string_view metric) {
  return metric == "mse" ? "MSE" : "relMSE";
}

// Commands spend time on their start and on files, which is not the method's.
std::string exchange_text(const std::vector<const ordered_json*>& shown) {
  double most = 0.0, all = 0.0;
  const ordered_json* slowest = nullptr;
  for (const ordered_json* result : shown) {
    const double exchange = mean_or(quantity(*result, "seconds_exchange"), 0.0);
    if (!(exchange > most)) continue;
    most = exchange;
    all = mean_or(quantity(*result, "seconds_sampling"), 0.0) +
          mean_or(quantity(*result, "seconds_filtering"), 0.0);
    slowest = result;
  }
  if (!slowest) return "";
  return fmt::format("Commands: {} takes {}, {} of it to start and for files (seconds_exchange).\n",
                     visible_text(shown_method(*slowest)), format_seconds(all),
                     format_seconds(most));
}

// How many have no verdict and why, and the result that stands on the fewest pixels.
std::string support_text(const Summary& summary, const std::vector<const ordered_json*>& shown) {
  constexpr double kRemarked = 0.2;  // share of the error in the worst 0.1 % of the pixels
  std::map<std::string, int> withheld;
  const ordered_json* fewest = nullptr;
  const char* of = "";
  double least = std::numeric_limits<double>::infinity();
  for (const ordered_json* result : shown) {
    for (const char* metric : {"relmse", "mse"}) {
      const ordered_json& ranked = summary.ranked(*result, metric);
      if (ranked.contains("withheld"))
        ++withheld[fmt::format("{} ({})", shown_metric(metric),
                               ranked["withheld"].get<std::string>())];
      const std::string name = metric;
      const double share = mean_or(quantity(*result, (name + "_worst_share").c_str()), 0.0);
      const double half = mean_or(quantity(*result, (name + "_half_pixels").c_str()), least);
      if (share < kRemarked || half >= least) continue;
      least = half, fewest = result, of = metric;
    }
  }
  std::string text;
  if (fewest) {
    const double share =
        mean_or(quantity(*fewest, (std::string(of) + "_worst_share").c_str()), 0.0);
    text += fmt::format(
        "Few pixels: {:.0f} bear half of the {} of {} ({}, {:g} spp), the worst "
        "0.1 % {:.0f} %.\n",
        std::max(1.0, least), shown_metric(of), visible_text(shown_method(*fewest)),
        visible_text(shown_scene(*fewest)), (*fewest)["spp"].get<double>(), 100.0 * share);
  }
  for (const auto& [why, count] : withheld) {
    const bool few = why.find("few pixels") != std::string::npos;
    text += fmt::format("No verdict on {}: {} result{}: {}.\n", why, count, count == 1 ? "" : "s",
                        withheld_remedy(few ? Withheld::kFewPixels : Withheld::kReferenceNoise));
  }
  return text;
}

std::string losses_text(const Summary& summary, const std::vector<const ordered_json*>& shown) {
  constexpr std::size_t kMost = 3;
  std::map<std::string, double> worst;
  for (const ordered_json* result : shown) {
    const ordered_json& ranked = summary.ranked(*result, "relmse");
    if (!ranked.contains("loses_energy")) continue;
    double& loss = worst[shown_method(*result)];
    loss = std::max(loss, ranked["loses_energy"].get<double>());
  }
  if (worst.empty()) return "";
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [method, loss] : worst)
    order.emplace_back(-loss, method);
  std::ranges::sort(order);
  std::vector<std::string> parts;
  for (const auto& [loss, method] : order) {
    if (parts.size() < kMost)
      parts.push_back(fmt::format("{} (up to {:.1f} %)", visible_text(method), -100.0 * loss));
  }
  if (order.size() > kMost) parts.push_back(fmt::format("{} more", order.size() - kMost));
  return fmt::format("Light is lost by more than 2 % beyond the interval: {}.\n",
                     fmt::join(parts, ", "));
}

}  // namespace

std::string summary_text(const ordered_json& statistics, bool wide) {
  const Summary summary(statistics);
  if (summary.empty()) return "no results\n";
  const bool shortened = summary.results().size() > kLongestTable;
  const auto shown = shortened ? best_of_each(summary.results()) : summary.results();
  const std::string baseline = statistics["baseline"].get<std::string>();
  const auto any = [&](const auto& is) {
    return std::ranges::any_of(shown, [&](const ordered_json* result) { return is(*result); });
  };
  std::string text = claims_text(statistics);
  text += wide ? wide_table(summary, shown) + equal_time_table(statistics)
               : short_table(summary, shown, baseline);
  text += fmt::format(
      "\nMean [95 % interval], best first; ratio to {} at the same budget. Verdicts: all pairs of\n"
      "a recording and budget together at 5 %.{}\n",
      visible_text(baseline), wide ? "" : " MSE, energy, times: --wide.");
  if (shortened) {
    text += fmt::format("The {} best by relMSE of each recording and budget, of {} in all.\n",
                        kBestShown, summary.results().size());
  }
  text += would_tell_text(summary, shown) + support_text(summary, shown) +
          losses_text(summary, shown) + exchange_text(shown);
  if (any([](const ordered_json& r) { return is_described_sampler(r) || is_described_filter(r); }))
    text += fmt::format("{}.\n", kByDescription);
  if (any([](const ordered_json& r) { return r["one_image"].get<bool>(); })) {
    text +=
        "Where all replicates are one image, the interval is that of its blocks of pixels and "
        "nothing is compared. An image made elsewhere is judged beside methods that got the same "
        "samples with --recorded-order --replicates 1.\n";
  }
  for (const std::string& about : summary.abouts())
    text += fmt::format("About {}.\n", visible_text(about));
  const std::string reference = (*summary.results().front())["reference"];
  text += fmt::format("Judged by: {}{}.\n", visible_text(reference),
                      summary.biased() ? " (BIASED: see spool evaluate --help)" : "");
  return text;
}

std::string summary_json(const ordered_json& statistics) {
  const Summary summary(statistics);
  ordered_json list = ordered_json::array();
  for (const ordered_json* result : summary.results()) {
    ordered_json entry = *result;
    entry["sampler_by_description"] = is_described_sampler(entry);
    entry["filter_by_description"] = is_described_filter(entry);
    entry["biased"] = entry["reference"].get<std::string>().ends_with("(biased)");
    for (const char* metric : {"relmse", "mse"}) {
      const ordered_json& ranked = summary.ranked(*result, metric);
      for (const char* key :
           {"letters", "ratio", "against_baseline", "against_best", "would_tell", "withheld"}) {
        if (ranked.contains(key)) entry["ranks"][metric][key] = ranked[key];
      }
    }
    list.push_back(std::move(entry));
  }
  return json_text(list);
}

}  // namespace spool::tools
