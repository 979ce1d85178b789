// What a cell of an experiment is called, and the cells of a plan in order.
#include "lib/experiment/experiment.h"

namespace spool {

std::string MethodChoice::label() const {
  std::string text = name;
  if (!preset.empty()) text += ":" + preset;
  if (set.empty()) return text;
  text += "{";
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (i > 0) text += ',';
    text += set[i].first + "=" + set[i].second;
  }
  return text + "}";
}

std::vector<Cell> all_cells(const std::vector<std::string>& dumps,
                            const std::vector<MethodChoice>& samplers,
                            const std::vector<MethodChoice>& filters,
                            const std::vector<double>& spp, int replicates,
                            const std::vector<int>& threads) {
  std::vector<Cell> cells;
  for (const std::string& dump : dumps) {
    for (const MethodChoice& sampler : samplers) {
      for (const double budget : spp) {
        for (int replicate = 0; replicate < replicates; ++replicate) {
          for (const int n : threads) {
            for (const MethodChoice& filter : filters)
              cells.push_back({dump, sampler, filter, budget, replicate, n});
          }
        }
      }
    }
  }
  return cells;
}

}  // namespace spool
