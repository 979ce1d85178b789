#include "lib/experiment/loop_filter.h"

#include <utility>

namespace spool {

LoopFilter loop_filter(const ReadyFilter& filter) {
  return
      [run = filter.run](const Selection& selection, const SamplePool& pool) -> Result<RgbImage> {
        SPOOL_ASSIGN(Reconstruction reconstruction, run(selection, pool, {}));
        return std::move(reconstruction.image);
      };
}

}  // namespace spool
