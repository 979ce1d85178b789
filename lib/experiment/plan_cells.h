// The scenes and the cells of a plan: their names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/option_table.h"
#include "lib/experiment/plan.h"

namespace spool {

// The recordings of one scene: those of a group, or one alone.
struct PlanScene {
  std::string group;  // empty: one recording alone
  std::vector<std::string> recordings;
};
std::vector<PlanScene> scenes_of(const Plan& plan);  // in the order of their first recordings

// Where a cell stands: indices into the lists of its plan.
struct CellPlace {
  std::size_t recording = 0, sampler = 0, spp = 0, replicate = 0, threads = 0, filter = 0;
};

// The cells of a plan in the order of Plan::cells(), each made when it is asked for: a plan may
// have millions. The plan must outlive it.
class PlanCells {
 public:
  explicit PlanCells(const Plan& plan);

  std::size_t size() const { return size_; }
  CellPlace place(std::size_t i) const;
  Cell cell(std::size_t i) const;
  // Names a cell among all cells of a plan and of what the plan says about all: the same on every
  // machine. Recordings count by their file name, not by their folder.
  std::uint64_t number(const Cell& cell) const;

 private:
  const Plan* plan_;
  std::size_t size_;
  OptionValues rules_, metrics_;
};

// 16 hexadecimal digits of the number.
std::string cell_id(std::uint64_t number);
std::string cell_id(const Cell& cell, const Plan& plan);
// The number of such a name; none when the text is none.
std::optional<std::uint64_t> cell_number(std::string_view id);

}  // namespace spool
