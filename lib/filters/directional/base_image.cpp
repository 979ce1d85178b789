#include "lib/filters/directional/base_image.h"

#include "lib/kernels/truncated_filter.h"

namespace spool {

Taps base_taps(BaseImage base) {
  return base == BaseImage::kNone ? Taps{0, {1.0}} : pixel_filter_taps();
}

Taps squared_base_taps(BaseImage base) {
  return squared_taps(base_taps(base));
}

}  // namespace spool
