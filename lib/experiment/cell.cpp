#include "lib/experiment/cell.h"

#include <fmt/core.h>

namespace spool {

std::string sampling_key(const Cell& cell) {
  return fmt::format("{}\n{}\n{}\n{}\n{}", cell.dump, cell.sampler.text(), cell.spp, cell.replicate,
                     cell.threads);
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
