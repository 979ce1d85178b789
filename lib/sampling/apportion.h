// Divides a whole number of samples in proportion to weights, exactly and in integers.
//
// The sum is min(budget, sum of caps) for every input; no share exceeds its cap. Integer arithmetic
// only, so the result depends neither on threads nor on the order of a floating-point sum: weights
// become 32-bit fractions of the largest. Whose quota R u / U is its cap or more gets the cap,
// until none is; the others get the floors of their quotas, and what is left goes one each to the
// largest remainders of the same quotas, ties to the lower index.
#pragma once

#include <span>
#include <vector>

namespace spool {

// weights: NaN and negative count as 0, +infinity as the largest finite one. When every weight with
// room left is 0, those are weighted equally. caps: one per weight, >= 0.
std::vector<long long> apportion(std::span<const double> weights, long long budget,
                                 std::span<const long long> caps);

}  // namespace spool
