#include "lib/methods/reading.h"

#include <algorithm>

namespace spool {

Result<OptionValues> reading_values(const std::vector<Reading>& known, std::string_view text) {
  OptionValues values;
  std::vector<const Reading*> taken;
  for (std::size_t plus = text.find('+'); plus != std::string_view::npos;) {
    const std::size_t next = text.find('+', plus + 1);
    const std::string_view name = text.substr(plus + 1, next - plus - 1);
    plus = next;
    const auto found = std::ranges::find(known, name, &Reading::name);
    if (found == known.end()) {
      return fail(
          ErrorCode::kUsage, "{}",
          unknown_name("reading", name, names_of(known), known.empty() ? ": it has none" : ""));
    }
    const auto same = std::ranges::find(taken, found->of, &Reading::of);
    if (same != taken.end()) {
      return fail(ErrorCode::kUsage, "'{}' and '{}' are both readings of {}: choose one",
                  (*same)->name, name, found->of);
    }
    taken.push_back(&*found);
    values.insert(values.end(), found->set.begin(), found->set.end());
  }
  return values;
}

}  // namespace spool
