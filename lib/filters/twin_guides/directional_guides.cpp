#include "lib/filters/twin_guides/directional_guides.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "lib/core/eight_floats.h"
#include "lib/core/exponential.h"
#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/fit_table.h"
#include "lib/filters/twin_guides/tiles.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr int kLeastReach = 5;
constexpr float kNoGradient = 1e-4f;  // squared difference of logarithms that is no structure
constexpr double kEnd = 7.0;
constexpr std::size_t kPlanes = 12;

// The exponent at (i, j) is even (i^2 + j^2) + straight (i^2 - j^2) + slanted 2 i j.
struct Shape {
  float even, straight, slanted;
};

// Pieces that hold all of the round Gaussian's weights, and of the longest one as much as those of
// the defaults do.
int reach_of(double sigma, double stretch) {
  const double widest =
      std::max(std::sqrt(2.0 * kEnd) * sigma, 5.0 * sigma * (1.0 + stretch) / 3.0);
  return std::max(kLeastReach, static_cast<int>(std::ceil(widest)));
}

// Half of the window: the other half has the same weights.
struct Offsets {
  int pairs = 0;  // of opposite offsets
  std::vector<int> dx, dy;
  std::vector<float> square, straight, slanted;  // padded with zeros to whole vectors

  explicit Offsets(int reach) {
    for (int j = 0; j <= reach; ++j) {
      for (int i = j == 0 ? 1 : -reach; i <= reach; ++i, ++pairs) {
        dx.push_back(i), dy.push_back(j);
        square.push_back(static_cast<float>(i * i + j * j));
        straight.push_back(static_cast<float>(i * i - j * j));
        slanted.push_back(static_cast<float>(2 * i * j));
      }
    }
    const std::size_t padded = (square.size() + 15) / 16 * 16;
    for (std::vector<float>* terms : {&square, &straight, &slanted})
      terms->resize(padded);
  }
};

SPOOL_VECTOR_CLONES
void weights_of(const Shape& shape, const float* square, const float* straight_of,
                const float* slanted_of, std::size_t padded, float end, float* __restrict weight) {
  const float even = shape.even, straight = shape.straight, slanted = shape.slanted;
  for (std::size_t k = 0; k < padded; ++k) {
    const float z = even * square[k] + straight * straight_of[k] + slanted * slanted_of[k];
    const float w = exp_negative(z) - end;
    weight[k] = w > 0.0f ? w : 0.0f;
  }
}

// sum of w (lanes - own) / sum of w, both ends of each pair: an even picture stays even to the bit.
template <class Vector>
[[gnu::always_inline]] inline void mean_of(const float* weight, const std::ptrdiff_t* step,
                                           int pairs, float centre, const float* own, float* mean) {
  constexpr int kParts = kLanes / kFloats<Vector>;
  Vector off[kParts], sum[kParts] = {}, u, v;
  std::memcpy(off, own, sizeof(off));
  float total = centre;
  for (int k = 0; k < pairs; ++k) {
    const float w = weight[k];
    if (!(w > 0.0f)) continue;
    for (int part = 0; part < kParts; ++part) {
      std::memcpy(&u, own + step[k] + part * kFloats<Vector>, sizeof(Vector));
      std::memcpy(&v, own - step[k] + part * kFloats<Vector>, sizeof(Vector));
      sum[part] += w * ((u - off[part]) + (v - off[part]));
    }
    total += 2.0f * w;
  }
  for (int part = 0; part < kParts; ++part) {
    off[part] += sum[part] / total;
    std::memcpy(mean + part * kFloats<Vector>, &off[part], sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void mean_of_lanes(const float* weight, const std::ptrdiff_t* step, int pairs,
                                       float centre, const float* own, float* mean),
                    mean_of<Vector>(weight, step, pairs, centre, own, mean))

Image<float> smooth_logarithm(const FloatRgb& pilot, double floor) {
  Image<float> l(pilot[0].width(), pilot[0].height());
  parallel_rows(0, l.height(), [&](int y) {
    for (std::size_t i = l.index(0, y); i < l.index(0, y + 1); ++i) {
      const float mean = (pilot[0][i] + pilot[1][i] + pilot[2][i]) / 3.0f;
      l[i] = std::log(std::max(mean, 0.0f) + static_cast<float>(floor));
    }
  });
  return convolve(l, four_sigma_taps(1.0));
}

struct Tensor {
  Image<float> xx, xy, yy;
};

Tensor structure_tensor(const Image<float>& l) {
  const int width = l.width(), height = l.height();
  Tensor t{Image<float>(width, height), Image<float>(width, height), Image<float>(width, height)};
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const float gx = l(std::min(x + 1, width - 1), y) - l(std::max(x - 1, 0), y);
      const float gy = l(x, std::min(y + 1, height - 1)) - l(x, std::max(y - 1, 0));
      t.xx(x, y) = gx * gx, t.xy(x, y) = gx * gy, t.yy(x, y) = gy * gy;
    }
  });
  const Taps taps = four_sigma_taps(2.0);
  return {convolve(t.xx, taps), convolve(t.xy, taps), convolve(t.yy, taps)};
}

Shape shape_of(float a, float b, float c, double sigma, double stretch) {
  const float root = std::sqrt((a - c) * (a - c) + 4.0f * b * b);
  const float coherence = root / (a + c + kNoGradient);
  const float f = 1.0f + static_cast<float>(stretch) * coherence * coherence;
  const auto per = static_cast<float>(0.5 / (sigma * sigma));
  const float across = per * f * f, along = per / (f * f);
  const float half = root > 0.0f ? 0.5f * (across - along) / root : 0.0f;
  return {0.5f * (across + along), half * (a - c), half * 2.0f * b};
}

// Means and variances of both kinds, one lane each. Sources: GuideSources, const or not.
template <class Sources>
auto planes_of(Sources& sources) {
  std::array<decltype(&sources.mean[0][0]), kPlanes> planes;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const std::size_t kind = i / 6, c = i % 3;
    planes[i] = i / 3 % 2 == 0 ? &sources.mean[kind][c] : &sources.variance[kind][c];
  }
  return planes;
}

std::vector<Piece> pieces_around(const Rectangle& tile, int reach,
                                 const std::array<const Image<float>*, kPlanes>& planes) {
  const int width = planes[0]->width(), height = planes[0]->height();
  std::vector<Piece> pieces(static_cast<std::size_t>(tile.width() + 2 * reach) *
                            static_cast<std::size_t>(tile.height() + 2 * reach));
  std::size_t place = 0;
  for (int y = tile.y0 - reach; y < tile.y1 + reach; ++y) {
    for (int x = tile.x0 - reach; x < tile.x1 + reach; ++x, ++place) {
      const std::size_t from =
          planes[0]->index(extend_symmetric(x, width), extend_symmetric(y, height));
      for (std::size_t i = 0; i < kPlanes; ++i)
        pieces[place].lanes[i] = (*planes[i])[from];
    }
  }
  return pieces;
}

}  // namespace

GuideSources blur_along(const GuideSources& sources, double sigma, double stretch,
                        double scene_luminance) {
  const Tensor tensor =
      structure_tensor(smooth_logarithm(sources.mean[0], kLogFloor * scene_luminance));
  GuideSources to = sources;
  const auto inputs = planes_of(sources);
  const auto planes = planes_of(to);
  const int reach = reach_of(sigma, stretch);
  const Offsets offsets(reach);
  const auto end = static_cast<float>(std::exp(-kEnd));
  parallel_tiles(tensor.xx.width(), tensor.xx.height(), [&](const Rectangle& tile) {
    const std::vector<Piece> pieces = pieces_around(tile, reach, inputs);
    const std::ptrdiff_t row = (tile.width() + 2 * reach) * kLanes;
    std::vector<std::ptrdiff_t> step(offsets.dx.size());
    for (std::size_t k = 0; k < step.size(); ++k)
      step[k] = offsets.dy[k] * row + offsets.dx[k] * kLanes;
    std::vector<float> weight(offsets.square.size());
    alignas(Piece) std::array<float, kLanes> mean;
    for (int y = tile.y0; y < tile.y1; ++y) {
      const float* own = pieces[0].lanes + (y - tile.y0 + reach) * row + reach * kLanes;
      for (int x = tile.x0; x < tile.x1; ++x, own += kLanes) {
        const std::size_t piece = tensor.xx.index(x, y);
        weights_of(shape_of(tensor.xx[piece], tensor.xy[piece], tensor.yy[piece], sigma, stretch),
                   offsets.square.data(), offsets.straight.data(), offsets.slanted.data(),
                   weight.size(), end, weight.data());
        mean_of_lanes(weight.data(), step.data(), offsets.pairs, 1.0f - end, own, mean.data());
        for (std::size_t i = 0; i < kPlanes; ++i)
          (*planes[i])[piece] = mean[i];
      }
    }
  });
  return to;
}

}  // namespace spool
