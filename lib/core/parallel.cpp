#include "lib/core/parallel.h"

#include <optional>

#include <oneapi/tbb/global_control.h>

namespace spool {

struct ThreadLimit::Control {
  std::optional<oneapi::tbb::global_control> limit;
};

ThreadLimit::ThreadLimit(int threads) : control_(std::make_unique<Control>()) {
  if (threads > 0) {
    control_->limit.emplace(oneapi::tbb::global_control::max_allowed_parallelism,
                            static_cast<std::size_t>(threads));
  }
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace spool
