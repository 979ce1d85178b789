// Eqs 7 and 8 in float, row by row: A = kept A + gain F with kept = (1 - alpha)^c and
// gain = (1 - kept) / c, c the passes over a region (attenuation.h), both worked out in double.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/sampling/multiscale/options.h"

namespace spool {

// What a row of entries needs to know of its regions; [x] each.
struct RegionRow {
  const std::int32_t* fresh;    // samples taken in this step
  const std::int32_t* closed;   // pieces that were saturated before it; null: none
  const std::int32_t* columns;  // of the area
  int rows = 0;                 // of the area
};

class PassWeights {
 public:
  PassWeights(int level, const MultiscaleOptions& options);

  // A of a row from f_k after and before the step.
  void update_row(const RegionRow& regions, const float* now, const float* before, int width,
                  float* attenuation) const;

 private:
  struct Weights {
    float kept, gain;
  };
  Weights weights_of(std::int32_t fresh, std::int32_t open) const;
  void update_entries(const RegionRow& regions, const float* now, const float* before, int begin,
                      int end, float* attenuation) const;

  AttenuationUpdate update_;
  double alpha_;
  int side_;                        // of a region that no border cuts, in pieces
  std::vector<float> kept_, gain_;  // of whole open regions by their fresh samples
};

}  // namespace spool
