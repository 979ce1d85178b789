// Recordings that break careless code, as one table: what docs/hard_cases.md lists, tests run.
//
// A case says how to make its pool, how many samples a pixel are worth replaying, and what may be
// promised beyond "finite and inside the pool". Every sampler and every filter of the lists
// in lib/ is run on each of them, so a method that is added is covered without a line here.
#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "lib/pool/sample_pool.h"

namespace spool::test {

struct HardCase {
  std::string name;                       // as in docs/hard_cases.md
  std::function<SamplePool()> pool;       // made anew by each caller
  std::vector<double> spp = {1, 2.5, 4};  // budgets, samples a pixel
  std::optional<double> value = {};       // every sample has this value: so must every image
  bool heavy = false;        // only one budget, and reduced unless everything is asked for
  bool featureless = false;  // methods that want features must refuse it and say so
};

const std::vector<HardCase>& hard_cases();
inline void PrintTo(const HardCase& hard, std::ostream* out) {
  *out << hard.name;
}

// SPOOL_HARD_CASES=whole: every pair of methods, at the sizes that docs/hard_cases.md states.
bool whole_hard_cases();

}  // namespace spool::test
