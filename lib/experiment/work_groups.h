// The cells of an experiment by the sampling runs that they share.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lib/experiment/cell.h"

namespace spool {

// Cells of one sampling run, in the order of the work.
struct WorkGroup {
  const std::vector<Cell>* cells;
  std::vector<std::size_t> members;

  const Cell& first() const { return (*cells)[members.front()]; }
  const std::string& dump() const { return first().dump; }
};

// Those that share a recording side by side; otherwise as they came. They point into `cells`.
std::vector<WorkGroup> work_groups(const std::vector<Cell>& cells);

}  // namespace spool
