#include "lib/sampling/multiscale/shared_progress.h"

#include <algorithm>

namespace spool {

SharedProgress::SharedProgress(const SamplingContext& context, long long budget)
    : context_(context), budget_(budget) {}

bool SharedProgress::operator()(long long taken) {
  const std::lock_guard lock(mutex_);
  spent_ += taken;
  if (context_.progress) {
    context_.progress(static_cast<double>(spent_) / static_cast<double>(std::max(budget_, 1LL)));
  }
  if (context_.cancelled != nullptr && (*context_.cancelled)()) cancelled_ = true;
  return !cancelled_;
}

}  // namespace spool
