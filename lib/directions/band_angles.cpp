#include "lib/directions/band_angles.h"

#include <cmath>
#include <numbers>

namespace spool {
namespace {

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

}  // namespace

std::vector<double> band_borders(int levels) {
  const double low = degrees(std::atan(0.5)), high = degrees(std::atan(2.0));
  switch (levels) {
    case 0:
      return {0.0};
    case 1:
      return {135.0, 45.0};
    case 2:
      return {0.0, 45.0, 90.0, 135.0};
    default:
      return {0.0, low, 45.0, high, 90.0, 180.0 - high, 135.0, 180.0 - low};
  }
}

std::vector<double> band_frequency_angles(int levels) {
  if (levels == 0) return {0.0};
  const std::vector<double> borders = band_borders(levels);
  std::vector<double> angles;
  for (std::size_t i = 0; i < borders.size(); ++i) {
    const double begin = borders[i];
    double end = borders[(i + 1) % borders.size()];
    if (end <= begin) end += 180.0;
    angles.push_back(std::fmod(0.5 * (begin + end), 180.0));
  }
  return angles;
}

std::vector<double> band_tangents(int levels) {
  std::vector<double> angles = band_frequency_angles(levels);
  for (double& angle : angles)
    angle = std::fmod(angle + 90.0, 180.0);
  return angles;
}

}  // namespace spool
