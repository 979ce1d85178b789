#include "lib/experiment/work_groups.h"

#include <algorithm>
#include <unordered_map>

#include <fmt/core.h>

namespace spool {
namespace {

// Equal for cells of one sampling run.
std::string sampling_key(const Cell& cell) {
  return fmt::format("{}\n{}\n{}\n{}\n{}", cell.dump, cell.sampler.text(), cell.spp, cell.replicate,
                     cell.threads);
}

}  // namespace

std::vector<WorkGroup> work_groups(const std::vector<Cell>& cells) {
  std::vector<WorkGroup> groups;
  std::unordered_map<std::string, std::size_t> group_of, dumps;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [at, fresh] = group_of.try_emplace(sampling_key(cells[i]), groups.size());
    if (fresh) groups.push_back({&cells, {}});
    groups[at->second].members.push_back(i);
    dumps.try_emplace(cells[i].dump, i);
  }
  std::ranges::stable_sort(groups, {},
                           [&](const WorkGroup& group) { return dumps.at(group.dump()); });
  return groups;
}

}  // namespace spool
