#include "lib/directions/sign_filter.h"

#include <array>
#include <cmath>

namespace spool {
namespace {

// v of the ladder filters with the sign (-1)^j applied.
constexpr std::array<double, 3> kPkva6 = {0.6261, 0.1794, 0.0688};
constexpr std::array<double, 4> kPkva8 = {0.6302, 0.1924, 0.0930, 0.0403};
constexpr std::array<double, 6> kPkva12 = {0.6300, 0.1930, 0.0972, 0.0526, 0.0272, 0.0144};

}  // namespace

std::span<const double> sign_coefficients(SignTaps taps) {
  switch (taps) {
    case SignTaps::kPkva6:
      return kPkva6;
    case SignTaps::kPkva8:
      return kPkva8;
    case SignTaps::kPkva12:
      break;
  }
  return kPkva12;
}

double sign_response(SignTaps taps, double u) {
  double sum = 0.0, j = 0.5;
  for (const double s : sign_coefficients(taps)) {
    sum += s * std::sin(j * u);
    j += 1.0;
  }
  return 2.0 * sum;
}

}  // namespace spool
