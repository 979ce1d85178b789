#include "lib/experiment/work_groups.h"

#include <algorithm>
#include <unordered_map>

namespace spool {

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
