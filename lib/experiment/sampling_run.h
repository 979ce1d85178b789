// What a sampling run gave.
#pragma once

#include <optional>
#include <vector>

#include "lib/experiment/experiment.h"

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

}  // namespace spool
