#include "tools/batch/runs_at_once.h"

#include <algorithm>

#include "lib/core/available_memory.h"
#include "lib/core/worker_threads.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

// A larger picture keeps all threads busy by itself.
constexpr long long kSmallPicture = 256 * 256;  // pixels

}  // namespace

int runs_at_once(const Plan& plan, const RecordedSamples& recording, const WorkingMemory& each) {
  const long long pixels = static_cast<long long>(recording.width()) * recording.height();
  if (pixels > kSmallPicture || std::ranges::any_of(plan.samplers, runs_alone) ||
      std::ranges::any_of(plan.filters, runs_alone)) {
    return 1;
  }
  const double bytes = each.per_pixel * static_cast<double>(pixels) + each.fixed;
  const auto free = available_memory();
  if (!free) return 1;
  const double fit = static_cast<double>(*free) / std::max(bytes, 1.0);
  return static_cast<int>(std::clamp(fit, 1.0, static_cast<double>(allowed_threads())));
}

}  // namespace spool::tools
