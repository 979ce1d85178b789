#include "lib/experiment/plan_cells.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "lib/core/random.h"

namespace spool {
namespace {

std::uint64_t hash_text(std::uint64_t seed, std::string_view text) {
  std::uint64_t state = mix(seed, text.size());
  for (const char c : text)
    state = mix(state, static_cast<unsigned char>(c));
  return state;
}

std::uint64_t hash_options(std::uint64_t seed, const OptionValues& values) {
  for (const auto& [name, value] : values)
    seed = hash_text(hash_text(seed, name), value);
  return seed;
}

// Of everything that decides a sampling run.
std::uint64_t hash_sampling(const Cell& cell, const Plan& plan, const OptionValues& rules) {
  const ExperimentOptions& e = plan.experiment;
  std::uint64_t state = hash_text(1, std::filesystem::path(cell.dump).filename().string());
  state = hash_text(state, cell.sampler.text());
  state = hash_text(state, format_number(cell.spp));
  state = mix(state, cell.replicate, e.seed, static_cast<int>(e.order), e.pieces_per_side,
              e.reference ? static_cast<int>(*e.reference) : -1, e.holdout.value_or(-1),
              cell.threads, e.repeats);
  if (e.decision_split) state = hash_text(state, "decision_split");
  if (e.fresh) state = hash_text(state, "fresh");
  return hash_options(state, rules);
}

}  // namespace

std::vector<PlanScene> scenes_of(const Plan& plan) {
  std::vector<PlanScene> scenes;
  for (std::size_t i = 0; i < plan.recordings.size(); ++i) {
    const std::string group = plan.group_of(i);
    const auto found = std::ranges::find(scenes, group, &PlanScene::group);
    if (group.empty() || found == scenes.end()) {
      scenes.push_back({group, {plan.recordings[i]}});
    } else {
      found->recordings.push_back(plan.recordings[i]);
    }
  }
  return scenes;
}

PlanCells::PlanCells(const Plan& plan)
    : plan_(&plan),
      size_(plan.recordings.size() * plan.samplers.size() * plan.spp.size() *
            static_cast<std::size_t>(plan.replicates) * plan.threads.size() * plan.filters.size()),
      rules_(option_values(sanitise_option_table(), plan.rules)),
      metrics_(option_values(metric_option_table(), plan.experiment.metrics)) {}

CellPlace PlanCells::place(std::size_t i) const {
  const Plan& plan = *plan_;
  const auto next = [&](std::size_t count) {
    const std::size_t place = i % count;
    i /= count;
    return place;
  };
  CellPlace place;
  place.filter = next(plan.filters.size());
  place.threads = next(plan.threads.size());
  place.replicate = next(static_cast<std::size_t>(plan.replicates));
  place.spp = next(plan.spp.size());
  place.sampler = next(plan.samplers.size());
  place.recording = i;
  return place;
}

Cell PlanCells::cell(std::size_t i) const {
  const CellPlace at = place(i);
  return {plan_->recordings[at.recording], plan_->samplers[at.sampler],
          plan_->filters[at.filter],       plan_->spp[at.spp],
          static_cast<int>(at.replicate),  plan_->threads[at.threads]};
}

std::uint64_t PlanCells::number(const Cell& cell) const {
  std::uint64_t state = hash_text(hash_sampling(cell, *plan_, rules_), cell.filter.text());
  state = hash_options(state, metrics_);
  for (const bool wanted : plan_->experiment.metrics.wanted)
    state = mix(state, wanted ? 1 : 0);
  for (const EnergyMask& mask : plan_->experiment.masks) {
    for (const std::string& text :
         {mask.name, mask.recording, std::filesystem::path(mask.path).filename().string()})
      state = hash_text(state, text);
  }
  return state;
}

std::string cell_id(std::uint64_t number) {
  return fmt::format("{:016x}", number);
}

std::optional<std::uint64_t> cell_number(std::string_view id) {
  std::uint64_t number = 0;
  const char* end = id.data() + id.size();
  if (id.size() != 16 || std::from_chars(id.data(), end, number, 16).ptr != end)
    return std::nullopt;
  return number;
}

std::string cell_id(const Cell& cell, const Plan& plan) {
  return cell_id(PlanCells(plan).number(cell));
}

std::vector<std::string> Plan::method_names() const {
  std::vector<std::string> names;
  for (const MethodChoice& sampler : samplers) {
    for (const MethodChoice& filter : filters)
      names.push_back(sampler.label() + " + " + filter.label());
  }
  return names;
}

Result<void> check_recording_names(const Plan& plan) {
  std::map<std::string, std::string> paths;
  for (const std::string& recording : plan.recordings) {
    const std::string name = std::filesystem::path(recording).filename().string();
    const auto [place, fresh] = paths.try_emplace(name, recording);
    if (fresh) continue;
    if (place->second == recording) {
      return fail(ErrorCode::kUsage, "{}: is there twice: name it once", recording);
    }
    return fail(ErrorCode::kUsage,
                "{} and {}: have the same file name, which names their results: rename one",
                place->second, recording);
  }
  return {};
}

Result<void> check_method_name(const Plan& plan, std::string_view name) {
  const std::vector<std::string> names = plan.method_names();
  if (std::ranges::find(names, name) != names.end()) return {};
  return fail(ErrorCode::kUsage, "{}",
              unknown_name("method of the plan", name, names,
                           ": write \"SAMPLER + FILTER\" by their labels"));
}

}  // namespace spool
