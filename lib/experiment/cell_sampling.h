// One sampling run: the samples that the cells of a group are made of, and what they are judged by.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/experiment/recording_in_use.h"

namespace spool {

// One sampling run with what its cells are judged by.
struct SampledPart {
  SamplePool pool;
  SamplingResult sampled;
  JudgingReference reference;
  std::optional<HalfSelections> halves;  // where fresh samples are asked for
};

// One part, or with crossfit the two halves of the recording, each judged by the other.
struct SamplingRun {
  std::vector<SampledPart> parts;
  SamplingDensity density;
  StageTime time;  // of one part
  ReferenceKind kind;
  double kurtosis;  // of the recording's samples
};

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
