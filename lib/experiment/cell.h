// A cell of an experiment: one recording, sampler, filter, budget and replicate.
#pragma once

#include <string>
#include <vector>

#include "lib/methods/method_text.h"

namespace spool {

struct Cell {
  std::string dump;  // as the loader knows it
  MethodChoice sampler, filter;
  double spp = 0;  // budget, samples per pixel
  int replicate = 0;
  int threads = 0;  // 0: as many as the process may use
  friend bool operator==(const Cell&, const Cell&) = default;
};

// Equal for cells of one sampling run, which share their samples.
std::string sampling_key(const Cell& cell);

// Every combination, recordings outermost, then samplers, spp, replicates, threads, filters.
std::vector<Cell> all_cells(const std::vector<std::string>& dumps,
                            const std::vector<MethodChoice>& samplers,
                            const std::vector<MethodChoice>& filters,
                            const std::vector<double>& spp, int replicates,
                            const std::vector<int>& threads = {0});

}  // namespace spool
