#include "tools/batch/registered_claims.h"

#include <set>
#include <string>

#include "lib/image_io/atomic_file.h"
#include "tools/json/study_json.h"

namespace spool::tools {
namespace {

constexpr const char* kFile = "claims.json";

}  // namespace

Result<void> register_claims(const std::filesystem::path& folder, const Plan& plan) {
  return write_text_file(folder / kFile, questions_text(plan.claims), true, true);
}

void mark_late_claims(const std::filesystem::path& folder, std::vector<ClaimFinding>& claims) {
  const std::set<std::string> known = kept_questions(folder / kFile);
  for (ClaimFinding& finding : claims)
    finding.after_results = !known.contains(question_of(finding.claim));
}

}  // namespace spool::tools
