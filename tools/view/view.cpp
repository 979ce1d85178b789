#include "tools/view/view.h"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "lib/core/random.h"
#include "lib/experiment/plan_reader.h"
#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/method_settings.h"
#include "tools/terminal/interrupt.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/page_generator.h"
#include "tools/verbs/report.h"
#include "tools/view/live_answers.h"
#include "tools/view/local_server.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kMostReplayBytes = std::size_t{256} << 20;
const GeneratorNeeds kNeeds = {"spool view", "numpy", "python3-numpy"};

template <class Function>
std::vector<MethodChoice> every_method(const MethodList<Function>& list) {
  std::vector<MethodChoice> choices;
  for (const Method<Function>& method : list) {
    if (method.argument.empty()) choices.push_back({method.name, "", {}});
  }
  return choices;
}

// Of a plan, those that can be replayed here. Others may be commands of another user.
template <class Function>
std::vector<MethodChoice> replayed(const MethodList<Function>& list,
                                   const std::vector<MethodChoice>& planned, bool allow_commands,
                                   std::vector<std::string>& left_out) {
  std::vector<MethodChoice> choices;
  for (const MethodChoice& choice : planned) {
    const bool replayable =
        choice.name == "exec" || find_method(list, choice.name)->argument.empty();
    const bool command = is_foreign_code(choice);  // a filter in a sampler's loop, too
    if (replayable && (!command || allow_commands)) {
      choices.push_back(choice);
    } else {
      const char* why = replayable && command ? "a command: --allow-commands" : choice.name.c_str();
      left_out.push_back(fmt::format("{} ({})", choice.label(), why));
    }
  }
  return choices;
}

// At most this many names: the line stays one.
std::string left_out_text(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 4;
  if (names.empty()) return "";
  const std::size_t shown = std::min(names.size(), kMost);
  const std::string more =
      names.size() > kMost ? fmt::format(" and {} more", names.size() - kMost) : "";
  return fmt::format("not replayed: {}{}",
                     fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                     more);
}

LiveChoices choices_of_recording(const fs::path& file) {
  return {{{file, file.stem().string()}}, {}, every_method(samplers()), every_method(filters())};
}

// What tools/report/live_page.py reads from a folder of results.
Result<LiveChoices> choices_of_results(const fs::path& folder, bool allow_commands) {
  SPOOL_ASSIGN(const std::string said,
               run_generator("live_page", {"--facts=" + folder.string()}, "", kNeeds));
  const auto facts = format::parse_json<ordered_json>(said);
  if (facts.is_discarded()) return fail(ErrorCode::kData, "{}: unreadable", folder.string());
  LiveChoices choices;
  for (const ordered_json& recording : facts["recordings"]) {
    choices.recordings.push_back(
        {recording["path"].get<std::string>(), recording["label"].get<std::string>()});
  }
  if (facts["seed"].is_number()) {  // the order of replicate 0
    choices.order.order = PoolOrder::kShuffled;
    choices.order.seed = mix(facts["seed"].get<std::uint64_t>(), std::uint64_t{0});
  }
  auto left_out = facts["left_out"].get<std::vector<std::string>>();
  if (std::error_code status; !fs::exists(folder / "plan.toml", status)) {
    choices.samplers = every_method(samplers());
    choices.filters = every_method(filters());
    choices.left_out = "no plan.toml in the folder: replayed are the program's methods";
    if (!left_out.empty()) choices.left_out += "; " + left_out_text(left_out);
    return choices;
  }
  SPOOL_ASSIGN(const Plan plan,
               read_plan(folder / "plan.toml", {known_samplers(), known_filters(), true}));
  choices.samplers = replayed(known_samplers(), plan.samplers, allow_commands, left_out);
  choices.filters = replayed(known_filters(), plan.filters, allow_commands, left_out);
  if (plan.experiment.reference == ReferenceKind::kCrossfit)
    left_out.emplace_back("the error (by crossfit, of two replays)");
  choices.left_out = left_out_text(left_out);
  choices.order.seed = mix(plan.experiment.seed, std::uint64_t{0});  // of methods, too
  choices.rules = plan.rules;
  choices.metrics = plan.experiment.metrics;
  choices.metrics.wanted.clear();
  choices.reference = plan.experiment.reference;
  choices.holdout = plan.experiment.holdout;
  return choices;
}

// Those that the user names beside them, commands too.
Result<void> add_named(const ViewOptions& options, LiveChoices& choices) {
  SPOOL_ASSIGN(const Methods named,
               choose_methods(split_methods(options.samplers), split_methods(options.filters), {}));
  const auto add = [](const auto& list, const auto& chosen, std::vector<MethodChoice>& all) {
    for (const MethodChoice& choice : choices_of(chosen)) {
      if (std::ranges::find(all, choice) == all.end()) all.push_back(choice);
    }
    return check_distinct(list.kind, all);
  };
  SPOOL_TRY(add(known_samplers(), named.samplers, choices.samplers));
  return add(known_filters(), named.filters, choices.filters);
}

Answer page_answer(const std::string& html) {
  return {200, "text/html; charset=utf-8", html};
}

// "results/" and "." have a name, too.
std::string title_of(const fs::path& target) {
  std::error_code status;
  const fs::path whole = fs::absolute(target, status).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

// The pages: of a recording the live one; of results the report, and the live one beside it.
Result<void> add_pages(const ViewOptions& options, bool of_results, Answers& answers) {
  SPOOL_ASSIGN(const std::string live,
               run_generator("live_page", {"--title=" + title_of(options.target)}, "", kNeeds));
  answers["live"] = [live](const Query&) { return page_answer(live); };
  answers[""] = answers["live"];
  if (!of_results) return {};
  SPOOL_ASSIGN(const std::string report, served_report(options.target));
  answers[""] = [report](const Query&) { return page_answer(report); };
  return {};
}

}  // namespace

Result<void> validate(const ViewOptions& options) {
  return check_bounds("port", options.port, kPort);
}

Result<void> run_view(const ViewOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  std::error_code status;
  const bool of_results = fs::is_directory(options.target, status);
  LiveChoices choices = choices_of_recording(options.target);
  if (of_results) {
    SPOOL_ASSIGN(choices, choices_of_results(options.target, options.allow_commands));
  }
  SPOOL_TRY(add_named(options, choices));
  print_note(choices.left_out);
  const auto replays = std::make_shared<LiveReplays>(std::move(choices), kMostReplayBytes);
  if (!of_results) SPOOL_TRY(replays->open(0));
  Answers answers = live_answers(replays);
  SPOOL_TRY(add_pages(options, of_results, answers));
  const InterruptNote note([] { return "the page is no longer served"; });
  return serve_locally(answers, options.port, [&](const std::string& url) {
    print_line(common.json ? ordered_json{{"url", url}}.dump()
                           : url + "  (open it on this machine; Ctrl-C ends it)");
    return check_output();
  });
}

}  // namespace spool::tools
