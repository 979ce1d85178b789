#include "tools/view/view.h"

#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "lib/core/random.h"
#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "tools/json/json_text.h"
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

// Those of the names that are methods of the library: others may be commands of other users.
template <class Function>
std::vector<MethodChoice> known_methods(const MethodList<Function>& list,
                                        const std::vector<std::string>& names) {
  std::vector<MethodChoice> choices;
  for (const std::string& name : names) {
    const Result<MethodChoice> choice = choose_method(list, name);
    if (choice && find_method(list, choice->name)->argument.empty() && make_method(list, *choice))
      choices.push_back(*choice);
  }
  return choices;
}

LiveChoices choices_of_recording(const fs::path& file) {
  return {{{file, file.stem().string()}}, {}, every_method(samplers()), every_method(filters())};
}

// What tools/report/live_page.py reads from a folder of results.
Result<LiveChoices> choices_of_results(const fs::path& folder) {
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
  choices.samplers = known_methods(samplers(), facts["samplers"].get<std::vector<std::string>>());
  choices.filters = known_methods(filters(), facts["filters"].get<std::vector<std::string>>());
  return choices;
}

Answer page_answer(const std::string& html) {
  return {200, "text/html; charset=utf-8", html};
}

// The pages: of a recording the live one; of results the report, and the live one beside it.
Result<void> add_pages(const ViewOptions& options, bool of_results, Answers& answers) {
  const std::string title = options.target.filename().string();
  SPOOL_ASSIGN(const std::string live,
               run_generator("live_page", {"--title=" + title}, "", kNeeds));
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
    SPOOL_ASSIGN(choices, choices_of_results(options.target));
  }
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
