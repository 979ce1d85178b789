// Text -> TOML that nests no deeper than the guard says. The limit is small here, so that short
// inputs reach it: a dot or a bracket that the guard takes for text would show.
#include "lib/experiment/toml_nesting.h"

#include <vector>

#include <toml++/toml.h>

#include "tests/fuzz/fuzz_input.h"

namespace {

std::size_t depth_of(const toml::table& root) {
  std::vector<std::pair<const toml::node*, std::size_t>> open = {{&root, 0}};
  std::size_t deepest = 0;
  while (!open.empty()) {
    const auto [node, depth] = open.back();
    open.pop_back();
    deepest = std::max(deepest, depth);
    if (const toml::table* table = node->as_table()) {
      for (const auto& [key, value] : *table)
        open.emplace_back(&value, depth + 1);
    } else if (const toml::array* array = node->as_array()) {
      for (const toml::node& value : *array)
        open.emplace_back(&value, depth + 1);
    }
  }
  return deepest;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  constexpr std::size_t kLimit = 2, kParts = kLimit + 1;
  if (line_nested_too_deeply(text, kLimit) != 0) return 0;
  try {
    const toml::table table = toml::parse(text);
    // A header of tables in lists, a key, and brackets that each hold a key.
    format::demand(depth_of(table) <= 2 * kParts + kParts + kLimit * (kParts + 1) + 1,
                   "what the guard lets through is shallow");
  } catch (const toml::parse_error&) {
  }
  return 0;
}
