// The direction of a line by a polynomial that compilers turn into vector code.
//
// atan on [0, 1] is the rational approximation of [Cephes, atan.c] (range reduction at 0.66,
// degrees 4 and 5), the rest of the circle follows by symmetry. Largest error found: 0.9 ULP;
// tests/filters/arctangent_test.cpp holds it to 2. No table, no libm: the same bits on every
// machine.
#pragma once

namespace spool {

// atan(q) for 0 <= q <= 1.
inline double atan_up_to_1(double q) {
  constexpr double kQuarterPi = 0.785398163397448309616;
  constexpr double kLowBits = 3.06161699786838301793e-17;  // of pi / 4
  const bool far = q > 0.66;
  const double x = far ? (q - 1.0) / (q + 1.0) : q;
  const double z = x * x;
  double p = -8.750608600031904122785e-1;
  p = p * z - 1.615753718733365076637e1;
  p = p * z - 7.500855792314704667340e1;
  p = p * z - 1.228866684490136173410e2;
  p = p * z - 6.485021904942025371773e1;
  double d = z + 2.485846490142306297962e1;
  d = d * z + 1.650270098316988542046e2;
  d = d * z + 4.328810604912902668951e2;
  d = d * z + 4.853903996359136964868e2;
  d = d * z + 1.945506571482613964425e2;
  const double near = x * (z * p / d) + x;
  return far ? kQuarterPi + (near + kLowBits) : near;
}

// The direction of the line through 0 and (dx, dy), degrees in [0, 180); 0 for (0, 0).
inline double line_direction(double dx, double dy) {
  constexpr double kPi = 3.14159265358979323846;
  const double ax = dx < 0.0 ? -dx : dx, ay = dy < 0.0 ? -dy : dy;
  const double longer = ax > ay ? ax : ay, shorter = ax > ay ? ay : ax;
  const double q = longer > 0.0 ? shorter / longer : 0.0;
  const double half = atan_up_to_1(q);
  const double first = ay > ax ? 0.5 * kPi - half : half;
  const bool falls = (dx < 0.0) != (dy < 0.0) && dy != 0.0 && dx != 0.0;
  const double degrees = (falls ? kPi - first : first) * (180.0 / kPi);
  return degrees < 180.0 ? degrees : 0.0;
}

}  // namespace spool
