#include "lib/pyramid/convolved_variance.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {
namespace {

// Squared weights of the pixels of an axis in one output, the last pixel first: within the image
// that is the order of the taps.
struct AxisWeights {
  int last = 0;
  std::vector<double> squares;
};

AxisWeights axis_weights(const Taps& taps, int x, int length, Extension extension) {
  int first = length - 1, last = 0;
  for (int i = taps.first; i <= taps.last(); ++i) {
    const int from = extend(x - i, length, extension);
    first = std::min(first, from);
    last = std::max(last, from);
  }
  AxisWeights weights{last, std::vector<double>(static_cast<std::size_t>(last - first + 1))};
  for (int i = taps.first; i <= taps.last(); ++i) {
    weights.squares[static_cast<std::size_t>(last - extend(x - i, length, extension))] +=
        taps.values[static_cast<std::size_t>(i - taps.first)];
  }
  for (double& weight : weights.squares)
    weight *= weight;
  return weights;
}

}  // namespace

void convolve_variance(Plane& variance, const Taps& taps, Extension extension) {
  const int width = variance.width(), height = variance.height();
  std::vector<AxisWeights> across;
  for (int x = 0; x < width; ++x)
    across.push_back(axis_weights(taps, x, width, extension));
  Plane rows(width, height);
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const AxisWeights& weights = across[static_cast<std::size_t>(x)];
      double sum = 0.0;
      for (std::size_t i = 0; i < weights.squares.size(); ++i)
        sum += weights.squares[i] * variance(weights.last - static_cast<int>(i), y);
      rows(x, y) = sum;
    }
  });
  parallel_rows(0, height, [&](int y) {
    const AxisWeights weights = axis_weights(taps, y, height, extension);
    std::fill(&variance(0, y), &variance(0, y) + width, 0.0);
    for (std::size_t i = 0; i < weights.squares.size(); ++i) {
      const double* from = &rows(0, weights.last - static_cast<int>(i));
      for (int x = 0; x < width; ++x)
        variance(x, y) += weights.squares[i] * from[x];
    }
  });
}

}  // namespace spool
