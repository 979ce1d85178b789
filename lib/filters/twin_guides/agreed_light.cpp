#include "lib/filters/twin_guides/agreed_light.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kFloor = 0.1;  // of the picture, in L: black does not shine

Image<float> shape_of(const FloatRgb& out, float floor) {
  Image<float> shape(out[0].width(), out[0].height());
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const auto l = static_cast<float>(luminance(out[0][i], out[1][i], out[2][i]));
    shape[i] = std::max(l, 0.0f) + floor;
  }
  return shape;
}

bool nothing_was_taken(const std::vector<Image<float>>& taken) {
  return std::all_of(taken.begin(), taken.end(), [](const Image<float>& group) {
    return std::all_of(group.pixels().begin(), group.pixels().end(),
                       [](float r) { return r == 0.0f; });
  });
}

}  // namespace

FloatRgb return_agreed_light(FloatRgb out, const std::vector<Image<float>>& taken, double sigma,
                             const RadianceScale& scale) {
  if (sigma <= 0.0 || taken.size() < 2 || nothing_was_taken(taken)) return out;
  const Taps taps = four_sigma_taps(sigma);
  std::vector<Image<float>> around(taken.size() + 1);
  parallel_for(around.size(), [&](std::size_t k) {
    around[k] = k < taken.size()
                    ? convolve(taken[k], taps)
                    : convolve(shape_of(out, static_cast<float>(kFloor * scale.mean)), taps);
  });
  parallel_rows(0, out[0].height(), [&](int y) {
    for (std::size_t i = out[0].index(0, y); i < out[0].index(0, y + 1); ++i) {
      float light = around[0][i];
      for (std::size_t k = 1; k < taken.size(); ++k)
        light = std::min(light, around[k][i]);
      const float factor = 1.0f + light / around.back()[i];
      for (Image<float>& channel : out)
        channel[i] *= factor;
    }
  });
  return out;
}

}  // namespace spool
