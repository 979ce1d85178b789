// One sampling run: the samples that the cells of a group are made of, and what they are judged by.
#pragma once

#include <functional>

#include "lib/experiment/experiment.h"
#include "lib/experiment/recording_in_use.h"
#include "lib/experiment/sampling_run.h"

namespace spool {

// How a sampling run and its cells go: alone, or beside others.
struct CellLane {
  bool alone = true;
  std::function<void(double)> report;  // share of the work on one cell

  CpuOf cpu() const { return alone ? CpuOf::kProcess : CpuOf::kThread; }
};

// What stays the same for all cells of an experiment.
struct CellWork {
  const ExperimentOptions& options;
  const ExperimentSources& sources;
  const std::function<bool()>* cancelled = nullptr;  // asked by samplers; null: never
};

// Errors: those of the recording, of the sampler, and of the reference that is asked for.
Result<SamplingRun> sample_cell(const CellWork& work, const Cell& cell,
                                const Result<ReadySampler>& sampler, RecordingInUse& recording,
                                const CellLane& lane);

}  // namespace spool
