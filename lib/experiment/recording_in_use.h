// The recording of the cells at work: one at a time, as they are large.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "lib/core/error.h"
#include "lib/experiment/stage_clock.h"
#include "lib/metrics/reference_side.h"
#include "lib/pool/recorded_samples.h"

namespace spool {

class RecordingInUse {
 public:
  using Load = std::function<Result<std::shared_ptr<const RecordedSamples>>(const std::string&)>;

  explicit RecordingInUse(const Load& load) : load_(load) {}

  // Frees the last recording before it reads another one. Safe from several threads while all of
  // them ask for the recording that is in use.
  Result<std::shared_ptr<const RecordedSamples>> get(const std::string& name);
  double kurtosis() const { return kurtosis_; }  // of its samples
  // Of its own reference; null where the picture is so large that it is not worth its memory.
  const std::shared_ptr<KeptSide>& reference_side() const { return side_; }
  // The time of its reading, once; then 0.
  StageTime take_reading();

 private:
  const Load& load_;
  bool known_ = false;
  std::string name_;
  Result<std::shared_ptr<const RecordedSamples>> samples_;
  double kurtosis_ = 0;
  std::shared_ptr<KeptSide> side_;
  StageTime reading_;
};

}  // namespace spool
