// The half-sample odd filter whose frequency response is nearly the sign of the frequency.
//
//   sigma(u) = 2 sum_j s_j sin((j + 1/2) u) ~ sign(u) for |u| < 2 pi,  s_j = (-1)^j v_j
//   tap(j) = +s_j, tap(-j-1) = -s_j, where tap a sits at offset a + 1/2
//
// v are the ladder filters of [PhoongKimVaidyanathanAnsari95]; modulation by pi turns their even
// response into this odd one.
#pragma once

#include <span>

namespace spool {

enum class SignTaps { kPkva6, kPkva8, kPkva12 };

std::span<const double> sign_coefficients(SignTaps taps);  // s_0 .. s_{J-1}, J = 3, 4, 6

double sign_response(SignTaps taps, double u);  // sigma(u)

}  // namespace spool
