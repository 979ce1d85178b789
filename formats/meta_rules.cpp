#include "formats/meta_rules.h"

#include "formats/bounded_json.h"
#include "formats/record_layout.h"

namespace spool::format {

static_assert(std::size_t{kMaxMetaDepth} == kMaxJsonDepth, "what may be stored can be read");

Judged<void> check_meta(std::string_view text) {
  using enum FailureClass;
  if (text.size() < kMinMetaBytes || text.size() > kMaxMetaBytes) {
    return violates(kDamaged, "meta has {} bytes, outside {}..{}", text.size(), kMinMetaBytes,
                    kMaxMetaBytes);
  }
  // accept() builds nothing.
  if (text.front() != '{' || !nests_within(text, kMaxMetaDepth) || !nlohmann::json::accept(text)) {
    return violates(kDamaged, "meta is not one JSON object of UTF-8");
  }
  return {};
}

}  // namespace spool::format
