// What is asked of one run of a plan.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/experiment/plan.h"

namespace spool::tools {

struct Shard {
  int index = 0, count = 1;
};
struct RunRequest {
  Plan plan;
  std::filesystem::path folder;
  std::filesystem::path inputs;  // only the inputs of each replicate are written, here
  std::optional<Shard> shard;    // only the cells of this one; results are then made by merging
  // Only the cells of these names, none: the folder is made ready; results as with a shard.
  std::optional<std::vector<std::string>> only;
  bool exact_timing = false;                      // one result after another
  bool wide = false;                              // the printed table: MSE, energy and times too
  bool merge = false;                             // no cell is run; results of what is there
  std::vector<std::filesystem::path> merge_from;  // folders whose cells and images are copied first
  // How far it is, and whether to end after the result at work; from any thread, both may be empty.
  std::function<void(double share, std::size_t results, std::size_t of)> progress;
  std::function<bool()> cancelled;
};

// Other cells of the plan are made elsewhere: results wait for a merge.
inline bool is_part(const RunRequest& request) {
  return request.shard || request.only;
}

}  // namespace spool::tools
