#include "lib/filters/twin_guides/agreed_light.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kFloor = 0.1;        // of the picture, in L: black does not shine
constexpr double kShortReach = 0.25;  // of sigma

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

std::vector<Image<float>> blurred(const std::vector<Image<float>>& groups, const Taps& taps) {
  std::vector<Image<float>> around(groups.size());
  parallel_for(around.size(), [&](std::size_t k) { around[k] = convolve(groups[k], taps); });
  return around;
}

// The light that all groups have around each piece; it is taken off them.
Image<float> agreed_around(std::vector<Image<float>>& taken, const Taps& taps) {
  const std::vector<Image<float>> around = blurred(taken, taps);
  Image<float> light = around[0];
  parallel_rows(0, light.height(), [&](int y) {
    for (std::size_t i = light.index(0, y); i < light.index(0, y + 1); ++i) {
      for (std::size_t k = 1; k < taken.size(); ++k)
        light[i] = std::min(light[i], around[k][i]);
      if (light[i] <= 0.0f) continue;
      for (std::size_t k = 0; k < taken.size(); ++k)
        taken[k][i] *= 1.0f - light[i] / around[k][i];
    }
  });
  return light;
}

// The mean of all groups but the one that has most.
Image<float> mean_of_others(const std::vector<Image<float>>& taken, const Taps& taps) {
  const std::vector<Image<float>> around = blurred(taken, taps);
  Image<float> light(around[0].width(), around[0].height());
  parallel_rows(0, light.height(), [&](int y) {
    for (std::size_t i = light.index(0, y); i < light.index(0, y + 1); ++i) {
      float sum = 0.0f, most = 0.0f;
      for (const Image<float>& group : around) {
        sum += group[i];
        most = std::max(most, group[i]);
      }
      light[i] = (sum - most) / static_cast<float>(around.size() - 1);
    }
  });
  return light;
}

}  // namespace

AgreedLight agreed_light(std::vector<Image<float>> taken, double sigma) {
  if (sigma <= 0.0 || taken.size() < 2 || nothing_was_taken(taken)) return {};
  AgreedLight agreed;
  agreed.near = agreed_around(taken, four_sigma_taps(kShortReach * sigma));
  agreed.far = mean_of_others(taken, four_sigma_taps(sigma));
  return agreed;
}

FloatRgb return_agreed_light(FloatRgb out, const AgreedLight& agreed, double sigma,
                             const RadianceScale& scale) {
  if (agreed.near.empty()) return out;
  const Image<float> shape = shape_of(out, static_cast<float>(kFloor * scale.mean));
  Image<float> factor(shape.width(), shape.height(), 1.0f);
  const auto add = [&](const Image<float>& light, double reach) {
    const Image<float> around = convolve(shape, four_sigma_taps(reach));
    parallel_rows(0, factor.height(), [&](int y) {
      for (std::size_t i = factor.index(0, y); i < factor.index(0, y + 1); ++i)
        factor[i] += light[i] / around[i];
    });
  };
  add(agreed.near, kShortReach * sigma);
  add(agreed.far, sigma);
  parallel_rows(0, factor.height(), [&](int y) {
    for (std::size_t i = factor.index(0, y); i < factor.index(0, y + 1); ++i) {
      for (Image<float>& channel : out)
        channel[i] *= factor[i];
    }
  });
  return out;
}

}  // namespace spool
