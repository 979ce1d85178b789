// The sampling runs of a plan with what they are expected to cost, those that a run does, and how
// many results are made beside each other.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/working_memory.h"
#include "lib/experiment/plan_shares.h"
#include "tools/batch/run_folder.h"
#include "tools/batch/run_request.h"

namespace spool::tools {

// Which of the plan's cells are done: those of the share, or of `request.only`. kUsage where `only`
// names a cell that the plan does not have.
Result<std::vector<bool>> chosen_cells(const RunRequest& request, const NamedCells& named);

// A sampling run that is left to do.
struct RunTask {
  std::string dump;
  std::vector<std::string> ids;  // of its cells
  double cost = 0.0;             // as costed_runs says
};
struct TasksLeft {
  std::vector<RunTask> tasks;  // the most expensive first
  std::size_t done = 0;        // cells that have a result in the folder
  int threads = 0;             // the most that a cell is to be timed with; 0: none says
};
Result<TasksLeft> tasks_left(const RunRequest& request);

// As many results beside each other as there are threads, where the picture is small and memory
// allows it; one where a plan runs commands of users, with threads and time limits of their own.
// `each`: the memory of one of them.
int runs_at_once(const Plan& plan, const RecordedSamples& recording, const WorkingMemory& each);

}  // namespace spool::tools
