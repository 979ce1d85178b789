// The results of a study in the order in which tables list them.
#pragma once

#include <string>
#include <vector>

#include "lib/study/study.h"

namespace spool {

// One result beside its ranks; they point into the study. Null: not ranked by that metric.
struct RankedResult {
  const MethodFinding* result = nullptr;
  const RankedFinding* relmse = nullptr;
  const RankedFinding* mse = nullptr;

  const StudyPlace& place() const { return result->place; }
  // Of a quantity by its name.
  const Interval& quantity(const std::string& name) const {
    return result->quantities[quantity_index(name)];
  }
};

// Those with a finished replicate, place by place in the order of the study, best relMSE first.
std::vector<RankedResult> ranked_results(const Study& study);

}  // namespace spool
