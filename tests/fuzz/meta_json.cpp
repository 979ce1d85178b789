// Text -> the rule of `meta` records. What is accepted is one JSON object to an ordinary parser
// too.
#include <nlohmann/json.hpp>

#include "formats/meta_rules.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool::format;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto judged = check_meta(text);
  if (!judged) {
    demand(judged.error().what.find('\n') == std::string::npos, "a reason is one line");
    return 0;
  }
  demand(nlohmann::json::parse(text, nullptr, false).is_object(), "what is accepted is an object");
  return 0;
}
