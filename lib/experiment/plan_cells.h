// The scenes and the cells of a plan: their names.
#pragma once

#include <string>
#include <vector>

#include "lib/experiment/plan.h"

namespace spool {

// The recordings of one scene: those of a group, or one alone.
struct PlanScene {
  std::string group;  // empty: one recording alone
  std::vector<std::string> recordings;
};
std::vector<PlanScene> scenes_of(const Plan& plan);  // in the order of their first recordings

// Names a cell among all cells of a plan and of what the plan says about all: 16 hexadecimal
// digits, the same on every machine. Recordings count by their file name, not by their folder.
std::string cell_id(const Cell& cell, const Plan& plan);

}  // namespace spool
