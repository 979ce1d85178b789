// The van der Corput sequence in base 2 [Niederreiter92, 3.1]: 0, 1/2, 1/4, 3/4, 1/8, ...
//
// Its first 2^k numbers are the multiples of 2^-k, and every longer beginning keeps those of a
// shorter one: replicates that start at these shares of a list are evenly apart, and adding
// replicates moves none.
#pragma once

namespace spool {

inline constexpr double radical_inverse(unsigned index) {
  double value = 0.0, digit = 0.5;
  for (; index > 0; index /= 2, digit *= 0.5)
    value += digit * (index % 2);
  return value;
}

}  // namespace spool
