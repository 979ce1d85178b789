// The folder that a plan's results go to: its cells, and what is checked before hours of work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan_cells.h"
#include "lib/study/method_results.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/run_request.h"

namespace spool::tools {

// The cells of a plan, which must outlive it, with their names.
class NamedCells {
 public:
  explicit NamedCells(const Plan& plan);

  std::size_t size() const { return cells_.size(); }
  Cell cell(std::size_t i) const { return cells_.cell(i); }
  std::string id(std::size_t i) const { return cell_id(numbers_[i]); }
  std::optional<std::size_t> find(const std::string& id) const;
  // One that has the name of another.
  std::optional<std::size_t> twice() const;

 private:
  PlanCells cells_;
  std::vector<std::uint64_t> numbers_;
  std::vector<std::size_t> order_;  // of the cells by their numbers
};

// The plan whose results lie in a folder; kIo where it is not what spool evaluate wrote.
Result<Plan> kept_plan(const std::filesystem::path& folder);

// Where a study takes the results of the plan from: the finished cells. Both must outlive it.
StudySources study_sources(const CellStore& store, const Plan& plan);

// kUsage when two cells would have one name.
Result<NamedCells> name_cells(const Plan& plan);

// Those of the plan. kData when a recording cannot give what the plan asks of it, or is not like
// others of its group; kUsage when it is there twice.
Result<std::vector<DumpIdentity>> check_dumps(const Plan& plan);

// Finished cells that are none of the plan's.
std::size_t count_others(const CellStore& store, const NamedCells& named);

// A folder of ours is continued, unfinished files of killed runs removed; a strange one is not
// touched (kUsage).
Result<CellStore> prepare_folder(const RunRequest& request, const NamedCells& named, bool force);

// With exact timing, kUsage where a wanted result that is there was timed beside others: it would
// stay.
Result<void> check_times(const RunRequest& request, const NamedCells& named,
                         const std::vector<bool>& wanted, const CellStore& store);

}  // namespace spool::tools
