#include "tools/batch/result_changes.h"

#include <algorithm>
#include <cmath>

#include "lib/core/counted.h"
#include "lib/experiment/plan_cells.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/run_folder.h"
#include "tools/methods/method_settings.h"

namespace spool::tools {

namespace fs = std::filesystem;

namespace {

std::string method_name(const MethodChoice& choice, MatchBy match) {
  if (match == MatchBy::kLabel) return choice.label();
  return match == MatchBy::kName ? choice.name
                                 : MethodChoice{choice.name, choice.preset, {}}.label();
}

std::string key_of(const PlanScene& scene, const MethodResults& method, double spp, int threads,
                   MatchBy match) {
  const std::string name =
      scene.group.empty() ? fs::path(scene.recordings.front()).stem().string() : scene.group;
  return fmt::format(
      "{}  {} + {}  {:g} spp{}", name, method_name(method.sampler, match),
      method_name(method.filter, match), spp,
      threads > 0 ? "  " + counted(static_cast<std::size_t>(threads), "thread") : "");
}

// Samples were drawn alike: replicate r of both took the same.
bool is_paired(const ResultFolder& a, const ResultFolder& b, const Combination& before,
               const Combination& after) {
  if (before.files != after.files || a.plan.experiment.seed != b.plan.experiment.seed ||
      a.plan.experiment.order != b.plan.experiment.order ||
      a.plan.replicates != b.plan.replicates) {
    return false;
  }
  return std::ranges::all_of(before.files, [&](const std::string& file) {
    const auto first = a.dumps.find(file), second = b.dumps.find(file);
    return first != a.dumps.end() && second != b.dumps.end() &&
           same_recording(first->second, second->second);
  });
}

// Those that are not the default, without what only says which metrics there are.
template <class Options>
std::string set_options(const OptionTable<Options>& table, const Options& options) {
  const OptionValues usual = option_values(table, Options{}),
                     values = option_values(table, options);
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == usual[i] || values[i].first == "perceptual") continue;
    text += fmt::format(", {}={}", values[i].first, values[i].second);
  }
  return text;
}

// By what a result was judged; rules for samples count where these make the reference.
std::string judge_of(const ResultRecord& record, const Plan& plan) {
  std::string text = record.text("reference");
  if (record.number("holdout") > 0.0) text += fmt::format(", {} held out", record.text("holdout"));
  if (record.text("reference") != reference_name(ReferenceKind::kIndependent))
    text += set_options(sanitise_option_table(), plan.rules);
  return text + set_options(metric_option_table(), plan.experiment.metrics);
}

Picture picture_of(const ResultRecord& record) {
  Picture picture;
  if (!record.text("width").empty())
    picture.size = fmt::format("{} x {} pixels", record.text("width"), record.text("height"));
  if (record.text("reference") == reference_name(ReferenceKind::kIndependent))
    picture.light = 1.0 / record.number("relative_scale");
  return picture;
}

// In what two recordings of one name are not of the same picture; empty: in nothing known. The
// noise of references moves their mean by less than kSameLight.
std::string other_picture(const DumpIdentity& a, const DumpIdentity& b, const Picture& before,
                          const Picture& after) {
  constexpr double kSameLight = 1.05;
  if (same_recording(a, b)) return "";
  if (!before.size.empty() && !after.size.empty() && before.size != after.size)
    return fmt::format("another recording: {} before, {} after", before.size, after.size);
  if (!before.scene.empty() && !after.scene.empty() && before.scene != after.scene)
    return fmt::format("another recording: of {} before, {} after", before.scene, after.scene);
  if (std::abs(std::log(after.light / before.light)) > std::log(kSameLight)) {
    return fmt::format("another recording: reference of mean luminance {:.4g} before, {:.4g} after",
                       before.light, after.light);
  }
  return "";
}

std::string other_picture(const ResultFolder& a, const ResultFolder& b, const Combination& before,
                          const Combination& after) {
  const auto first = a.dumps.find(before.files.front()), second = b.dumps.find(after.files.front());
  if (first == a.dumps.end() || second == b.dumps.end()) return "";
  return other_picture(first->second, second->second, before.picture, after.picture);
}

Series series_of(const MethodResults& results, const std::string& metric) {
  if (metric != kCpuTime) return results.series(quantity_index(metric));
  Series sum = results.series(quantity_index("cpu_sampling"));
  const Series filtering = results.series(quantity_index("cpu_filtering"));
  for (std::size_t r = 0; r < sum.values.size(); ++r)
    sum.values[r] += filtering.values[r];
  return sum;
}

}  // namespace

Result<ResultFolder> read_result_folder(const fs::path& path, MatchBy match) {
  ResultFolder folder{path, {}, {}, {}, {}};
  SPOOL_ASSIGN(folder.plan, kept_plan(path));
  SPOOL_ASSIGN(const std::vector<DumpIdentity> dumps, known_dumps(path));
  for (const DumpIdentity& dump : dumps)
    folder.dumps[dump.path.filename().string()] = dump;
  SPOOL_ASSIGN(const CellStore store, CellStore::open(path));
  std::string judged;  // of the scene's first result, as is the picture
  Picture picture;
  StudySources sources = study_sources(store, folder.plan);
  sources.read = [&, read = std::move(sources.read)](const Cell& cell) {
    Result<ResultRecord> record = read(cell);
    if (judged.empty() && record && !record->failed()) {
      judged = judge_of(*record, folder.plan);
      picture = picture_of(*record);
    }
    return record;
  };
  for (const PlanScene& scene : scenes_of(folder.plan)) {
    std::vector<std::string> files;
    for (const std::string& recording : scene.recordings)
      files.push_back(fs::path(recording).filename().string());
    judged.clear();
    picture = {};
    SceneMethods found = read_scene(folder.plan, scene, sources);
    if (const auto dump = folder.dumps.find(files.front()); dump != folder.dumps.end())
      picture.scene = scene_name(dump->second);
    const int wanted = folder.plan.replicates * static_cast<int>(files.size());
    for (std::size_t b = 0; b < folder.plan.spp.size(); ++b) {
      for (std::size_t t = 0; t < folder.plan.threads.size(); ++t) {
        const double spp = folder.plan.spp[b];
        const int threads = folder.plan.threads[t];
        for (MethodResults& method : found[t][b]) {
          if (method.done + method.failed == 0) continue;
          const std::string key = key_of(scene, method, spp, threads, match);
          const std::string shown = key_of(scene, method, spp, threads, MatchBy::kLabel);
          const auto [place, fresh] = folder.combinations.try_emplace(key);
          if (!fresh) {
            return fail(ErrorCode::kUsage,
                        "{}: --match name: {} and {} have one name: compare folders with one "
                        "setting of each method, or match by label",
                        path.string(), place->second.key, shown);
          }
          place->second = {shown, std::move(method), files, judged, picture, wanted};
        }
      }
    }
  }
  if (folder.combinations.empty()) return nothing_finished(path, store);
  if (store.damaged() > 0) folder.damage = store.damage();
  return folder;
}

Change compare_one(const ResultFolder& a, const ResultFolder& b, const Combination& before,
                   const Combination& after, const std::string& metric) {
  const Series first = series_of(before.results, metric), second = series_of(after.results, metric);
  const Range range =
      metric == kCpuTime ? Range::kPositive : quantities()[quantity_index(metric)].range;
  Change change;
  change.key = before.key;
  if (before.key != after.key) change.key += " -> " + after.key;
  change.metric = metric;
  change.biased = before.results.biased || after.results.biased;
  change.before = mean_interval(first, range).mean;
  change.after = mean_interval(second, range).mean;
  change.judged_differently = other_picture(a, b, before, after);
  if (!change.judged_differently.empty()) return change;
  const bool known = !before.judged.empty() && !after.judged.empty();
  if (metric != kCpuTime && known && before.judged != after.judged) {
    change.judged_differently = fmt::format("{} before, {} after", before.judged, after.judged);
    return change;
  }
  change.paired = metric != kCpuTime && is_paired(a, b, before, after);
  change.difference = change.paired ? compare_paired(second, first, better_of(metric))
                                    : compare_independent(second, first, better_of(metric));
  return change;
}

void judge(std::vector<Change>& changes, double significance, double tolerance) {
  std::vector<double> p;
  std::vector<Comparison> differences;
  for (const Change& change : changes) {
    p.push_back(change.difference.p);
    differences.push_back(change.difference);
  }
  const std::vector<double> adjusted = family_of(differences, p).p;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Change& change = changes[i];
    change.p = adjusted[i];
    change.verdict = change.difference.identical
                         ? Verdict::kIdentical
                         : verdict_of(change.difference, change.p, significance);
    const bool small =
        std::abs(change.after - change.before) <= tolerance * std::abs(change.before);
    const bool told = change.verdict == Verdict::kBetter || change.verdict == Verdict::kWorse;
    if (told && small && tolerance > 0.0) change.verdict = Verdict::kUndecided;
  }
}

}  // namespace spool::tools
