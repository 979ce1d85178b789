#include "lib/kernels/event_places.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "lib/core/check.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

constexpr double kPairsByChance = 10.0;

struct Around {
  Plane sum;    // of G_sigma * c_k
  Plane pairs;  // of (G_sigma * c_j)(G_sigma * c_k), j != k
};

Around around(const std::vector<Plane>& groups, double sigma) {
  const Taps taps = four_sigma_taps(sigma);
  Around result{Plane(groups[0].width(), groups[0].height()), {}};
  Plane squares = result.sum;
  for (const Plane& group : groups) {
    const Plane blurred = convolve(group, taps);
    for (std::size_t i = 0; i < squares.size(); ++i) {
      result.sum[i] += blurred[i];
      squares[i] += blurred[i] * blurred[i];
    }
  }
  for (std::size_t i = 0; i < squares.size(); ++i)
    squares[i] = std::max(result.sum[i] * result.sum[i] - squares[i], 0.0);
  result.pairs = std::move(squares);
  return result;
}

}  // namespace

EventPlaces event_places(const std::vector<Plane>& groups, double near, double far, double m) {
  SPOOL_CHECK(groups.size() >= 2);
  const double pi = std::numbers::pi;
  const double by_chance = kPairsByChance / (2.0 * pi * far * far * 4.0 * pi * near * near * m * m);
  Around close = around(groups, near);
  const Around window = around(groups, far);
  EventPlaces places{convolve(close.pairs, four_sigma_taps(far)), std::move(close.sum)};
  for (std::size_t i = 0; i < window.sum.size(); ++i) {
    places.correlation[i] = (places.correlation[i] + by_chance) / (window.pairs[i] + by_chance);
    places.density[i] = window.sum[i] > 0.0 ? places.density[i] / window.sum[i] : 0.0;
  }
  return places;
}

}  // namespace spool
