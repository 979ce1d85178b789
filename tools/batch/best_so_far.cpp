#include "tools/batch/best_so_far.h"

#include <cmath>
#include <filesystem>

#include <fmt/core.h>

namespace spool::tools {

void BestSoFar::add(const Cell& cell, double error) {
  if (!std::isfinite(error)) return;
  condition_ =
      fmt::format("{} at {:g} spp", std::filesystem::path(cell.dump).stem().string(), cell.spp);
  Mean& mean = means_[condition_][cell.sampler.label() + " + " + cell.filter.label()];
  mean.sum += error;
  ++mean.n;
}

std::string BestSoFar::describe() const {
  if (condition_.empty()) return "";
  const std::string* best = nullptr;
  double least = 0.0;
  for (const auto& [method, mean] : means_.at(condition_)) {
    const double error = mean.sum / mean.n;
    if (best && error >= least) continue;
    best = &method;
    least = error;
  }
  return fmt::format(", best on {}: {}, relMSE {:.3g}", condition_, *best, least);
}

}  // namespace spool::tools
