#include "lib/statistics/edge_share.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/check.h"

namespace spool {
namespace {

constexpr double kEdges = 0.1;   // of all pixels
constexpr double kFloor = 1e-3;  // of the mean: noise of black pixels makes no edges
constexpr int kReach = 2;        // pixels

double slope(const Plane& of, int x, int y, int dx, int dy) {
  const auto at = [&](int step) {
    return of(std::clamp(x + step * dx, 0, of.width() - 1),
              std::clamp(y + step * dy, 0, of.height() - 1));
  };
  return at(1) - at(-1);
}

// Squared gradient of the logarithm; NaN beside pixels without a value.
Plane gradient_of(const Plane& luminance) {
  double sum = 0.0, known = 0.0;
  for (const double value : luminance.pixels()) {
    if (!std::isfinite(value)) continue;
    sum += value;
    known += 1.0;
  }
  const double floor = kFloor * sum / known;
  Plane log(luminance.width(), luminance.height());
  for (std::size_t i = 0; i < log.size(); ++i)
    log[i] = std::isfinite(luminance[i]) ? std::log(std::max(luminance[i], floor)) : std::nan("");
  Plane gradient(log.width(), log.height());
  for (int y = 0; y < log.height(); ++y) {
    for (int x = 0; x < log.width(); ++x) {
      const double dx = slope(log, x, y, 1, 0), dy = slope(log, x, y, 0, 1);
      gradient(x, y) = dx * dx + dy * dy;
    }
  }
  return gradient;
}

// 1 within kReach pixels of an edge.
Image<char> near_edges(const Plane& luminance) {
  const Plane gradient = gradient_of(luminance);
  std::vector<double> sorted;
  std::ranges::copy_if(gradient.pixels(), std::back_inserter(sorted),
                       [](double value) { return value > 0.0; });
  Image<char> near(luminance.width(), luminance.height(), 0);
  if (sorted.empty()) return near;
  const std::size_t edges = std::min(
      sorted.size(), static_cast<std::size_t>(kEdges * static_cast<double>(gradient.size())) + 1);
  const auto least = sorted.begin() + static_cast<std::ptrdiff_t>(edges - 1);
  std::ranges::nth_element(sorted, least, std::greater<>());
  for (int y = 0; y < near.height(); ++y) {
    for (int x = 0; x < near.width(); ++x) {
      if (!(gradient(x, y) >= *least)) continue;
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, near.height() - 1); ++v) {
        for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, near.width() - 1); ++u)
          near(u, v) = 1;
      }
    }
  }
  return near;
}

}  // namespace

double edge_share(const Image<int>& counts, const Plane& luminance) {
  if (counts.empty()) return std::nan("");
  const int least = *std::ranges::min_element(counts.pixels());
  double all = 0.0, at_edges = 0.0;
  for (const int count : counts.pixels())
    all += count - least;
  if (all == 0.0) return std::nan("");
  SPOOL_CHECK_EQ(counts.width() % luminance.width(), 0);
  const int side = counts.width() / luminance.width();
  const Image<char> near = near_edges(luminance);
  if (std::ranges::find(near.pixels(), 1) == near.pixels().end()) return std::nan("");
  for (int y = 0; y < counts.height(); ++y) {
    for (int x = 0; x < counts.width(); ++x) {
      if (near(x / side, y / side)) at_edges += counts(x, y) - least;
    }
  }
  return at_edges / all;
}

}  // namespace spool
