#include "lib/filters/twin_guides/coarser_inputs.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "lib/core/eight_floats.h"

namespace spool {
namespace {

constexpr int kRadius = 2;
constexpr double kSigma = 1.2;  // pieces of the lattice

struct Tap {
  int step, right, down;  // in the table; in the lattice
  float factor;           // the small Gaussian for the window's
  const float* weights;   // of the row at hand
};

std::vector<Tap> taps_of(const WindowWeights& weights, double sigma, const FitTable& table,
                         std::vector<std::size_t>& offsets) {
  std::vector<Tap> taps;
  for (std::size_t o = 0; o < weights.offsets().size(); ++o) {
    const auto [dx, dy] = weights.offsets()[o];
    if (std::max(std::abs(dx), std::abs(dy)) > kRadius) continue;
    const double d2 = dx * dx + dy * dy;
    const double factor = std::exp(d2 / (2.0 * sigma * sigma) - d2 / (2.0 * kSigma * kSigma));
    taps.push_back({table.step(dx, dy), dx, dy, static_cast<float>(factor), nullptr});
    offsets.push_back(o);
  }
  return taps;
}

// sum of w (lanes - own) / sum of w: an even picture stays even to the bit.
template <class Vector>
[[gnu::always_inline]] inline void mean_of(const Tap* taps, std::size_t count, int x,
                                           const float* own, float* mean) {
  constexpr int kParts = kLanes / kFloats<Vector>;
  Vector off[kParts], sum[kParts] = {}, u;
  std::memcpy(off, own, sizeof(off));
  float total = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float w = taps[i].weights[x] * taps[i].factor;
    if (!(w > 0.0f)) continue;
    const float* at = own + static_cast<std::ptrdiff_t>(taps[i].step) * kLanes;
    for (int part = 0; part < kParts; ++part) {
      std::memcpy(&u, at + part * kFloats<Vector>, sizeof(Vector));
      sum[part] += w * (u - off[part]);
    }
    total += w;
  }
  for (int part = 0; part < kParts; ++part) {
    sum[part] /= total;
    std::memcpy(mean + part * kFloats<Vector>, &sum[part], sizeof(Vector));
  }
}

SPOOL_VECTOR_WIDTHS(void mean_of_lanes(const Tap* taps, std::size_t count, int x, const float* own,
                                       float* mean),
                    mean_of<Vector>(taps, count, x, own, mean))

float mean_logarithm(const std::vector<Tap>& taps, int x, const Lattice& lattice, int px, int py,
                     const Image<float>& logarithm) {
  float sum = 0.0f, total = 0.0f;
  for (const Tap& tap : taps) {
    const float w = tap.weights[x] * tap.factor;
    if (!(w > 0.0f)) continue;  // beyond the border, too
    sum += w * logarithm(lattice.column(px + tap.right), lattice.row(py + tap.down));
    total += w;
  }
  return sum / total;
}

}  // namespace

void coarser_inputs(const Lattice& lattice, const Rectangle& tile, const WindowWeights& weights,
                    double sigma, const FitTable& table, const ScaleInputs& inputs,
                    ScaleInputs& to) {
  std::vector<std::size_t> offsets;
  std::vector<Tap> taps = taps_of(weights, sigma, table, offsets);
  const auto rows = static_cast<std::size_t>(table.rows());
  const float pieces = static_cast<float>(lattice.step) / kPerPosition;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (std::size_t i = 0; i < taps.size(); ++i)
      taps[i].weights = weights.row(offsets[i], tile.x0, y);
    for (int x = tile.x0; x < tile.x1; ++x) {
      std::array<float, kLanes> more;
      mean_of_lanes(taps.data(), taps.size(), x - tile.x0, table.lanes(table.place(x, y)),
                    more.data());
      const std::size_t piece = to.down.index(lattice.column(x), lattice.row(y));
      to.down[piece] = inputs.down[piece] + pieces * more[1];
      to.right[piece] = inputs.right[piece] + pieces * more[2];
      for (std::size_t c = 0; c < inputs.features.size(); ++c)
        to.features[c][piece] = inputs.features[c][piece] + more[kPosition + c];
      for (std::size_t c = 0; c < 3; ++c) {
        to.colour[c][piece] = inputs.colour[c][piece] + more[rows + c];
        to.difference[c][piece] = inputs.difference[c][piece] + more[rows + 3 + c];
      }
      to.log_luminance[piece] =
          mean_logarithm(taps, x - tile.x0, lattice, x, y, inputs.log_luminance);
    }
  }
}

}  // namespace spool
