// How much structure an image has along each direction: smoothed band energies, less their noise.
//
//   E_i = max(G_s * D_i^2 - g_i (G_s * v), 0),  s = 0.35 2^k pieces          [LiuZheng (section 4)]
//
// D_i: directional band i of a detail image; v: variance of the mean per piece; g_i: the band's
// gain for white noise. T is double or float (float is enough for a filter's width).
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/directions/directional_filter_bank.h"
#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {

enum class DirectionMeasure {
  kEnergy,  // E_i
  kAbs,  // M_i = G_s * |D_i|; corrected: sqrt(max(M_i^2 - (2 / pi) N_i, 0)), as |normal| has mean
         // sqrt(2 / pi)
};

struct EnergyOptions {
  DirectionMeasure measure = DirectionMeasure::kEnergy;
  bool noise_correct = true;
  double smoothing = 0.35;  // s / 2^k
  double stand_out = 2.0;   // multiples of the noise that count as energy of every direction
  Extension extension = Extension::kSymmetric;
};

OptionTable<EnergyOptions> energy_option_table();

// The bands of one detail image and their noise gains.
template <class T>
struct NoisyBands {
  std::vector<Image<T>> bands;
  std::vector<double> gains;
};

template <class T>
struct DirectionalEnergy {
  std::vector<Image<T>> energy;   // [band], >= 0, in the unit of the measure
  Image<std::uint8_t> isotropic;  // 1 where no direction stands out: take every direction as equal
};

// Energies for pixels of `level` (k >= 1). Isotropic: max_i E_i <= 1e-3 mean_i N_i or <= 1e-20
// (squares of the abs measure). The energies lie where the bands lay.
template <class T>
DirectionalEnergy<T> directional_energy(NoisyBands<T> source, const Plane& variance, int level,
                                        const EnergyOptions& options, GuardCounts& guards);

}  // namespace spool
