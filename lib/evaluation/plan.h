// Experiment plans: one TOML file names recordings, methods, sweeps and budgets, and says it all.
//
//   title = "attenuation"
//   recordings = ["chess.spool", "../blinds.spool"]    # relative to the plan
//   spp = [2, 4, 8]
//   replicates = 5
//   seed = 1
//   order = "shuffled"            # or "recorded"
//   reference = "independent"     # absent: the best there is
//   holdout = 16                  # samples per pixel, absent: what the reference wants
//   pieces_per_side = 1
//   samplers = ["uniform"]        # by name only, and in full:
//   [[sampler]]
//   name = "multiscale"
//   preset = "robust"
//   alpha = [0.3, 0.4, 0.5]       # a list of values is a sweep: every combination
//   [[filter]]
//   name = "box"
//   [pool]                        # rules for samples that are no ordinary numbers
//   [metrics]                     # options of the metrics
//
// Everything is checked before any work: an unknown key, method, preset or option is an error with
// its line and the nearest known name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/evaluation/experiment.h"
#include "lib/pool/sanitise.h"

namespace spool {

struct Plan {
  std::string title;
  std::vector<std::string> recordings;          // paths, joined with the plan's folder
  std::vector<MethodChoice> samplers, filters;  // sweeps written out
  std::vector<double> spp;
  int replicates = 5;
  ExperimentOptions experiment;
  SanitiseRules rules;

  std::vector<Cell> cells() const {
    return all_cells(recordings, samplers, filters, spp, replicates);
  }
};

// The methods that a plan may name.
struct PlanVocabulary {
  const std::vector<SamplerEntry>& samplers;
  const std::vector<ReconstructorEntry>& filters;
};

// Errors: kIo when the file cannot be read, kUsage for everything that is wrong in it.
Result<Plan> read_plan(const std::filesystem::path& path, const PlanVocabulary& vocabulary);
// `name` is for messages, `folder` what recordings are relative to.
Result<Plan> parse_plan(std::string_view text, const std::string& name,
                        const std::filesystem::path& folder, const PlanVocabulary& vocabulary);

// Names a cell among all cells of a plan and of what the plan says about all: 16 hexadecimal
// digits, the same on every machine. Recordings count by the name given, not by their folder.
std::string cell_id(const Cell& cell, const Plan& plan);

// Which of `shards` machines does the cell: cells that share a sampling run go together.
int shard_of(const Cell& cell, const Plan& plan, int shards);

}  // namespace spool
