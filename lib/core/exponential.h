// exp(-x) for x >= 0 by a polynomial that compilers turn into vector code.
//
// x is split as n ln 2 + r with |r| <= ln(2) / 2 (ln 2 in two parts), exp(-r) is its Taylor series
// and 2^-n goes straight into the exponent bits. Largest error found over the whole range: 1.0 ULP
// (float), 1.0 ULP (double); tests/filters/exponential_test.cpp holds it to 2. Results below
// the smallest normal number are 0: such a weight beside the centre's 1 is nothing. No table, no
// libm: the same bits on every machine.
#pragma once

#include <bit>
#include <cstdint>

namespace spool {

// `small` where the mask is set, else `large`. No branch and no comparison of floats: either leaves
// a loop for AVX2 without vectors (g++ 12).
template <class Float, class Bits>
Float choose(Bits mask, Float small, Float large) {
  return std::bit_cast<Float>((std::bit_cast<Bits>(small) & mask) |
                              (std::bit_cast<Bits>(large) & ~mask));
}

inline float exp_negative(float x) {
  constexpr float kInverseLn2 = 1.44269504f;
  constexpr float kLn2High = 0.693145752f, kLn2Low = 1.42860677e-6f;
  constexpr float kLargest = 87.3f;      // exp(-87.3) is still a normal number
  constexpr float kRound = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer
  const std::int32_t magnitude = std::bit_cast<std::int32_t>(x) & 0x7FFFFFFF;
  const std::int32_t beyond = magnitude - std::bit_cast<std::int32_t>(kLargest);
  const auto below = static_cast<std::uint32_t>(beyond >> 31);
  const float bounded = choose(below, x, kLargest);  // NaN becomes kLargest
  const float shifted = bounded * kInverseLn2 + kRound;
  const float n = shifted - kRound;
  const float r = n * kLn2High - bounded + n * kLn2Low;  // -(x - n ln 2)
  float p = 1.0f / 5040.0f;
  p = p * r + 1.0f / 720.0f;
  p = p * r + 1.0f / 120.0f;
  p = p * r + 1.0f / 24.0f;
  p = p * r + 1.0f / 6.0f;
  p = p * r + 0.5f;
  p = p * r * r + r + 1.0f;
  const auto bits = std::bit_cast<std::uint32_t>(shifted);  // low bits hold n
  return p * std::bit_cast<float>(((127u - (bits & 0x1FFu)) << 23) & below);
}

inline double exp_negative(double x) {
  constexpr double kInverseLn2 = 1.4426950408889634;
  constexpr double kLn2High = 0.69314718036912382, kLn2Low = 1.9082149292705877e-10;
  constexpr double kLargest = 708.0;
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52
  const double bounded = x < kLargest ? x : kLargest;
  const double shifted = bounded * kInverseLn2 + kRound;
  const double n = shifted - kRound;
  const double r = n * kLn2High - bounded + n * kLn2Low;
  double p = 1.0 / 6227020800.0;
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = p * r * r + r + 1.0;
  const auto bits = std::bit_cast<std::uint64_t>(shifted);
  const double scale = std::bit_cast<double>((1023u - (bits & 0xFFFu)) << 52);
  return x < kLargest ? p * scale : 0.0;
}

}  // namespace spool
