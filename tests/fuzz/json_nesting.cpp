// Text -> JSON with bounds. What is accepted is no deeper than it may be and survives being copied
// and written; what an ordinary parser takes and is shallow is accepted.
#include "formats/bounded_json.h"

#include <vector>

#include "tests/fuzz/fuzz_input.h"

namespace {

// Without recursion, so that the target itself has no stack to lose.
std::size_t depth_of(const nlohmann::json& root) {
  std::vector<std::pair<const nlohmann::json*, std::size_t>> open = {{&root, 1}};
  std::size_t deepest = 0;
  while (!open.empty()) {
    const auto [value, depth] = open.back();
    open.pop_back();
    if (!value->is_structured()) continue;
    deepest = std::max(deepest, depth);
    for (const auto& inner : *value)
      open.emplace_back(&inner, depth + 1);
  }
  return deepest;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool::format;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const nlohmann::json value = parse_json(text);
  const nlohmann::json free = nlohmann::json::parse(text, nullptr, false);
  if (value.is_discarded()) {
    // nlohmann/json takes a byte 0 for the end of the text and ignores what follows.
    const bool whole = text.find('\0') == std::string_view::npos;
    demand(free.is_discarded() || !whole || depth_of(free) > kMaxJsonDepth,
           "what is shallow is accepted");
    return 0;
  }
  demand(text.find('\0') == std::string_view::npos, "nothing stands behind the end");
  demand(depth_of(value) <= kMaxJsonDepth, "what is accepted is shallow");
  const nlohmann::json copy = value;
  demand(copy == value, "a copy is the same");
  const std::string written = copy.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  demand(!parse_json(written, SIZE_MAX).is_discarded(), "what is written can be read");
  return 0;
}
