#include "tools/batch/registered_claims.h"

#include <algorithm>
#include <set>
#include <string>

#include "formats/bounded_json.h"
#include "lib/image_io/atomic_file.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/claims_json.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// What a claim asks, without what was found.
std::string question_of(const ordered_json& claim) {
  ordered_json question;
  for (const char* key : {"text", "better", "than", "metric", "samples", "below", "spp"}) {
    if (claim.contains(key)) question[key] = claim[key];
  }
  return question.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

Result<void> register_claims(const fs::path& folder, const Plan& plan) {
  const fs::path file = folder / "claims.json";
  const bool has_results =
      CellStore(folder).count_others([](const std::string&) { return false; }) > 0;
  if (has_results) return {};
  ordered_json list = ordered_json::array();
  for (const ordered_json& claim : claims_json(plan, {}))
    list.push_back(question_of(claim));
  return write_text_file(file, list.dump(1) + "\n", true, true);
}

void mark_late_claims(const fs::path& folder, ordered_json& statistics) {
  std::set<std::string> known;
  const auto kept = format::parse_json_file<ordered_json>(folder / "claims.json");
  if (kept.is_array()) {
    for (const ordered_json& question : kept) {
      if (question.is_string()) known.insert(question.get<std::string>());
    }
  }
  for (ordered_json& claim : statistics["claims"]) {
    if (!known.contains(question_of(claim))) claim["after_results"] = true;
  }
}

}  // namespace spool::tools
