// `spool figure`: what goes into a paper, from the folder that `spool evaluate` wrote, or from a
// plan that is evaluated first: comparisons with insets, curves, captions, tables.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/terminal/console.h"

namespace spool::tools {

struct FigureOptions {
  std::filesystem::path source;         // DIR, or PLAN.toml
  std::filesystem::path output;         // folder
  std::string metric;                   // empty: relmse
  double spp = 0.0;                     // 0: the largest budget
  std::vector<std::string> recordings;  // empty: all
  std::vector<std::string> methods;     // "sampler + filter"; empty: own, baseline, best
  std::vector<std::string> crops;       // "[RECORDING:]X,Y,W,H"; empty: where methods differ
  int column = 0;                       // 1, 2; 0: as many as the figure needs
  std::string font;                     // "latex[:PACKAGE]"; empty: matplotlib's
};

Result<void> validate(const FigureOptions& options);
// A plan's results go to output/results, where an interrupted evaluation goes on. Errors are those
// of run_evaluate, run_generator and the script.
Result<void> run_figure(const FigureOptions& options, const CommonOptions& common);

}  // namespace spool::tools
