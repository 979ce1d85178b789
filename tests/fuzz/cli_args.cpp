// Lines -> the arguments that spool takes apart itself: lists of methods, presets, settings. The
// first byte says which of the lines are samplers, filters and settings. Making a method runs
// nothing; images are not looked for outside an empty folder.
#include "tests/fuzz/fuzz_input.h"
#include "tools/methods/method_settings.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool;
  if (size == 0) return 0;
  std::vector<std::string> lines(1);
  for (size_t i = 1; i < size && lines.size() < 9; ++i) {
    if (data[i] == '\n')
      lines.emplace_back();
    else
      lines.back() += static_cast<char>(data[i]);
  }
  std::vector<std::string> samplers = split_methods(lines[0]), filters;
  if (lines.size() > 1) filters = split_methods(lines[1]);
  tools::MethodOptions options;
  if (lines.size() > 2 && (data[0] & 1) != 0) options.preset = lines[2];
  for (size_t i = 3; i < lines.size(); ++i)
    options.settings.push_back(lines[i]);
  const auto methods = tools::choose_methods(samplers, filters, options);
  if (!methods) {
    format::demand(!methods.error().message.empty(), "a refusal has a reason");
    return 0;
  }
  format::demand(methods->samplers.size() == samplers.size(), "every sampler is chosen");
  format::demand(methods->filters.size() == filters.size(), "every filter is chosen");
  for (const auto& sampler : methods->samplers) {
    const auto again = tools::choose_methods({sampler.choice.text()}, {}, {});
    format::demand(again && again->samplers[0].choice == sampler.choice,
                   "a method's text names it");
  }
  return 0;
}
