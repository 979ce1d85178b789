// Text -> a plan. What is accepted comes back from its own text as the same cells.
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/plan_reader.h"
#include "lib/experiment/plan_text.h"
#include "tests/fuzz/fuzz_input.h"

namespace spool {
namespace {

struct ToyOptions {
  double alpha = 0.5;
  bool fast = false;
};

const OptionTable<ToyOptions>& toy_table() {
  static const OptionTable<ToyOptions> table = {
      number_option("alpha", &ToyOptions::alpha, 0.0, 1.0, "a share"),
      switch_option("fast", &ToyOptions::fast, "quickly")};
  return table;
}

template <class Function>
Method<Function> toy(const char* name) {
  Method<Function> entry;
  entry.name = name;
  entry.presets = {"robust"};
  entry.make = [](std::string_view preset, const OptionValues& set) -> Result<Ready<Function>> {
    if (!preset.empty() && preset != "robust")
      return fail(ErrorCode::kUsage, "unknown preset '{}'", preset);
    SPOOL_TRY(with_options(toy_table(), ToyOptions{}, set));
    return Ready<Function>{};
  };
  return entry;
}

}  // namespace
}  // namespace spool

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool;
  static const MethodList<SamplerFunction> samplers = {
      "sampler", {toy<SamplerFunction>("uniform"), toy<SamplerFunction>("multiscale")}};
  static const MethodList<FilterFunction> filters = {"filter", {toy<FilterFunction>("box")}};
  const PlanVocabulary vocabulary{samplers, filters};
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto plan = parse_plan(text, "plan.toml", "/lab", vocabulary);
  if (!plan) {
    format::demand(plan.error().message.find('\n') == std::string::npos, "an error is one line");
    return 0;
  }
  const auto again = parse_plan(plan_text(*plan), "plan.toml", "/elsewhere", vocabulary);
  format::demand(again.has_value(), "the text of a plan is a plan");
  const auto cells = plan->cells(), same = again->cells();
  format::demand(cells.size() == same.size(), "it has as many cells");
  if (!cells.empty())
    format::demand(cell_id(cells.back(), *plan) == cell_id(same.back(), *again),
                   "and they are the same");
  return 0;
}
