#include "tools/batch/evaluation_summary.h"

#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "lib/core/visible_text.h"
#include "tools/batch/claims_json.h"
#include "tools/console.h"
#include "tools/json_text.h"
#include "tools/methods/external_methods.h"

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
      if (metric == "relmse") abouts_.emplace_back(condition["about"]["text"]);
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
  std::set<std::string> abouts() const { return {abouts_.begin(), abouts_.end()}; }

  // As the ranking of the metric has it; an empty object where it has not.
  ordered_json ranked(const ordered_json& result, const char* metric) const {
    const auto of_metric = ranked_.find(metric);
    if (of_metric == ranked_.end()) return ordered_json::object();
    const auto found = of_metric->second.find(name_of(place_of(result), result));
    return found == of_metric->second.end() ? ordered_json::object() : found->second;
  }

 private:
  std::size_t rank_of(const ordered_json& result) const {
    return ranked(result, "relmse").value("place", std::size_t{1} << 40);
  }

  Ranked ranked_;
  std::vector<std::string> abouts_;
  std::vector<const ordered_json*> results_;
  bool threads_ = false, biased_ = false;
};

std::string ratio_text(const ordered_json& ranked) {
  const auto ratio = ranked.find("ratio");
  if (ratio == ranked.end() || ratio->empty()) return "-";
  return fmt::format("{:.3f}", (*ratio)[0].get<double>());
}

// "ab, better": letters, and the verdict against uniform + box.
std::string verdict_text(const ordered_json& ranked) {
  std::string text = ranked.value("letters", std::string());
  if (text.empty()) text = "-";
  const std::string against = ranked.value("against_baseline", std::string());
  return against.empty() ? text : text + " " + against;
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

}  // namespace

std::string summary_text(const ordered_json& statistics) {
  const Summary summary(statistics);
  if (summary.empty()) return "no results\n";
  const bool shortened = summary.results().size() > kLongestTable;
  const auto shown = shortened ? best_of_each(summary.results()) : summary.results();
  std::vector<std::vector<std::string>> rows = {
      {"dump", "sampler", "filter", "spp", "spent", "relMSE", "x uniform+box", "verdict", "MSE",
       "x uniform+box", "energy", "sampling", "filtering"}};
  if (summary.has_threads()) rows.front().emplace_back("threads");
  bool described = false, one_image = false;
  for (const ordered_json* result : shown) {
    const std::string sampler = (*result)["sampler"], filter = (*result)["filter"];
    const bool of_sampler = is_described_sampler(*result);
    const bool of_filter = is_described_filter(*result);
    described = described || of_sampler || of_filter;
    one_image = one_image || (*result)["one_image"].get<bool>();
    const ordered_json relmse = summary.ranked(*result, "relmse");
    const double seconds[] = {mean_or(quantity(*result, "seconds_sampling"), 0.0),
                              mean_or(quantity(*result, "seconds_filtering"), 0.0)};
    rows.push_back({std::filesystem::path((*result)["dump"].get<std::string>()).stem().string(),
                    sampler + (of_sampler ? kByDescriptionMark : ""),
                    filter + (of_filter ? kByDescriptionMark : ""),
                    fmt::format("{:g}", (*result)["spp"].get<double>()),
                    fmt::format("{:.4g}", mean_or(quantity(*result, "samples_per_pixel"), 0.0)),
                    value_text(quantity(*result, "relmse")), ratio_text(relmse),
                    verdict_text(relmse), value_text(quantity(*result, "mse")),
                    ratio_text(summary.ranked(*result, "mse")), energy_text(*result, relmse),
                    format_seconds(seconds[0]), format_seconds(seconds[1])});
    if (summary.has_threads()) {
      rows.back().push_back(std::to_string((*result)["threads"].get<int>()));
    }
  }
  std::string text = claims_text(statistics) + format_columns(rows, 3);
  if (shortened) {
    text += fmt::format("\nThe {} best by relMSE of each recording and budget, of {} in all.\n",
                        kBestShown, summary.results().size());
  }
  if (described) text += fmt::format("\n{}.\n", kByDescription);
  if (one_image) {
    text +=
        "\nWhere all replicates are one image, the interval is that of its blocks of pixels and "
        "nothing is compared. An image made elsewhere is judged beside methods that got the same "
        "samples with --recorded-order --replicates 1.\n";
  }
  text +=
      "\nMean [95 % interval], best relMSE first. Methods that share a letter are not told apart "
      "(all pairs of a recording and budget together at 5 %); better, worse: than uniform + box.\n";
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
      const ordered_json ranked = summary.ranked(*result, metric);
      for (const char* key : {"letters", "ratio", "against_baseline", "against_best"}) {
        if (ranked.contains(key)) entry["ranks"][metric][key] = ranked[key];
      }
    }
    list.push_back(std::move(entry));
  }
  return json_text(list);
}

}  // namespace spool::tools
