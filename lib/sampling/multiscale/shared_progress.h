// Progress and cancellation of a run, from several tiles at once.
#pragma once

#include <mutex>

#include "lib/sampling/sampler.h"

namespace spool {

class SharedProgress {
 public:
  SharedProgress(const SamplingContext& context, long long budget);
  // `taken`: samples since the last call; false when the run is to stop.
  bool operator()(long long taken);
  bool cancelled() const { return cancelled_; }

 private:
  const SamplingContext& context_;
  long long budget_;
  long long spent_ = 0;
  bool cancelled_ = false;
  std::mutex mutex_;
};

}  // namespace spool
