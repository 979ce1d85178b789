// Where something was found: one scene, budget and number of threads; and the two methods.
#pragma once

#include <compare>
#include <string>

namespace spool {

struct StudyPlace {
  std::string recording;  // the first of the scene
  double spp = 0;         // the budget
  int threads = 0;        // 0: as many as the process may use
  std::string group;      // of the scene; empty: the recording stands alone

  friend bool operator==(const StudyPlace&, const StudyPlace&) = default;
  friend auto operator<=>(const StudyPlace&, const StudyPlace&) = default;
};

// By their labels.
struct MethodPair {
  std::string sampler, filter;

  std::string name() const { return sampler + " + " + filter; }
};

}  // namespace spool
