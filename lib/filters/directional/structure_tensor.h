// Directional energies from the smoothed tensor of the gradient: a cheap rival of the filter bank.
//
//   J = G_s * (grad f grad f^T) - noise,  E(beta) = n^T J n,  n = (cos, sin)(beta + 90)
//
// f = f_{k-1}, central differences, symmetric extension, s as for the bank's energies. Noise: the
// gains of the two differences of f_{k-1}, times G_s * v.
// Slow twin: tests/reference/structure_tensor_reference.h.
#pragma once

#include <span>

#include "lib/core/guards.h"
#include "lib/directions/directional_energy.h"
#include "lib/filters/directional/options.h"

namespace spool {

// Energies for pixels of `level` along `angles` (degrees, spatial); arguments as filter_widths.
template <class T>
DirectionalEnergy<T> structure_tensor_energy(const Pyramid& pyramid, const Plane& variance,
                                             int level, std::span<const double> angles,
                                             const DirectionalOptions& options,
                                             GuardCounts& guards);

}  // namespace spool
