#include "lib/metrics/energy_masks.h"

#include <cmath>

namespace spool {

Result<MetricValue> energy_in_mask(const RgbImage& estimate, const RgbImage& reference,
                                   const EnergyMask& mask, const BootstrapOptions& bootstrap) {
  const int width = reference[0].width(), height = reference[0].height();
  if (mask.plane.width() != width || mask.plane.height() != height) {
    return fail(ErrorCode::kData, "{}: is {} x {} pixels, the image {} x {}: make it as large",
                mask.path, mask.plane.width(), mask.plane.height(), width, height);
  }
  const BlockBootstrap blocks(width, height, bootstrap);
  std::vector<double> estimated(static_cast<std::size_t>(blocks.blocks())), expected(estimated);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!(mask.plane(x, y) > 0.5)) continue;
      double e = 0.0, r = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        e += estimate[c](x, y);
        r += reference[c](x, y);
      }
      if (!std::isfinite(e) || !std::isfinite(r)) continue;
      const auto b = static_cast<std::size_t>(blocks.block_of(x, y));
      estimated[b] += e;
      expected[b] += r;
    }
  }
  const Estimate ratio = ratio_of_sums(blocks, estimated, expected);
  MetricValue value{ratio.value, ratio.standard_error};
  if (!std::isfinite(value.value)) value = {};
  return value;
}

}  // namespace spool
