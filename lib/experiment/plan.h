// Experiment plans: one TOML file names recordings, methods, sweeps and budgets, and says it all.
//
//   title = "attenuation"
//   recordings = ["chess.spool", "../blinds.spool"]    # relative to the plan
//   spp = [2, 4, 8]
//   replicates = 8
//   seed = 1
//   order = "disjoint"            # or "shuffled", "recorded": which samples replicates take
//   reference = "independent"     # absent: the best there is
//   holdout = 16                  # samples per pixel, absent: what the reference requires
//   pieces_per_side = 1
//   decision_split = false        # true: no sample decides about its own half
//   fresh = false                 # true: also the counts on samples that had no part in them
//   halves = true                 # false: how much errors vary between recordings is assumed from
//                                 # shared samples and not measured on halves; a third less time
//   threads = [1, 2]              # a sweep too; absent: as many as the process may use
//   repeats = 3                   # of sampling and filtering, for the median of their times
//   pictures = true               # images of replicate 0
//   samplers = ["uniform"]        # by name only, and in full:
//   [[sampler]]
//   name = "multiscale"
//   preset = "robust"
//   alpha = [0.3, 0.4, 0.5]       # a list of values is a sweep: every combination
//   label = "ours"                # its name in every table and file; of a sweep "ours{alpha=0.3}"
//   [[filter]]
//   name = "box"
//   baseline = "uniform + box"    # the method that ratios are to, by its labels
//   energy_band = [0.98, 1.02]    # ranks among methods that keep the energy so far; absent: all
//   [[dump]]                      # a recording, where several are of one scene
//   file = "chess_2.spool"
//   group = "chess"               # their replicates are counted together
//   [[mask]]                      # a part of the image whose energy is looked at
//   name = "bulbs"
//   file = "bulbs.exr"            # pixels above 0.5; relative to the plan
//   recording = "chess.spool"     # absent: all
//   [[claim]]                     # a question, written down before the run
//   text = "ours is better than uniform sampling"
//   better = "multiscale + directional"
//   than = "uniform + box"
//   metric = "mse"                # relmse where nothing is said
//   spp = [4, 8]                  # absent: all
//   samples = "fresh"             # or "own": on samples that had no part in the counts
//   below = 1.1                   # the ratio that must lie below; 1 where nothing is said
//   source = "LiuZheng, Figure 12"
//   [pool]                        # rules for samples that are no ordinary numbers
//   [metrics]                     # options of the metrics
//   only = ["smape"]              # these, and those of tables and claims; absent: all metrics.
//                                 # Where no option is set: metrics = ["smape"], a key above
//
// Everything is checked before any work: an unknown key, method, preset or option is an error with
// its line and the nearest known name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/experiment.h"
#include "lib/inference/claims.h"
#include "lib/methods/method_list.h"
#include "lib/pool/sanitise.h"

namespace spool {

struct Plan {
  std::string title;
  std::vector<std::string> recordings;  // paths, joined with the plan's folder
  std::vector<std::string> groups;      // [recording] of one scene; empty, or "": one of its own
  std::vector<MethodChoice> samplers, filters;  // sweeps written out
  std::vector<double> spp;
  int replicates = 8;
  std::vector<int> threads = {0};
  bool pictures = true;
  ExperimentOptions experiment;  // masks: names and paths only, until the files are read
  SanitiseRules rules;
  // Energy ratio, lowest and highest, of the methods that are ranked.
  std::optional<std::pair<double, double>> energy_band;

  std::vector<Claim> claims;
  std::string baseline;  // "SAMPLER + FILTER"; empty: uniform + box

  std::string group_of(std::size_t recording) const {
    return recording < groups.size() ? groups[recording] : std::string();
  }
  std::vector<std::string> method_names() const;  // every sampler with every filter, by labels
  // Replicates whose pools are split to measure their spread: two, where there are intervals.
  int measured_halves() const { return replicates > 1 ? 2 : 0; }
  std::vector<Cell> cells() const {
    return all_cells(recordings, samplers, filters, spp, replicates, threads);
  }
};

// kUsage when `name` is no method of the plan.
Result<void> check_method_name(const Plan& plan, std::string_view name);

// kUsage when two of the recordings are the same or have the same file name: cells are named by it.
Result<void> check_recording_names(const Plan& plan);

}  // namespace spool
