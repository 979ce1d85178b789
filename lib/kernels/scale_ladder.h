// The ladder of Gaussians of greedy error minimisation and the test for climbing it
// [RousselleKnausZwicker11]; shared by the sampler and the reconstruction of that name.
//
//   I_0 = pixel filter * means,  I_s = G(sigma_s) * I_0
//   gain = Var_{s-1} - Var_s,  loss = beta_s (I_s - I_{s-1})^2
//   beta_1 = 1,  beta_s = (sigma_s^2 + sigma_{s-1}^2) / (sigma_s^2 - sigma_{s-1}^2)
//   stop_s where the channels' mean of z loss - gain >= 0,
//   z = -ln(1 - (1.9 gamma)^{1/sqrt 2}) (1 - 1/N)
//
// N: samples under the peak-normalised kernel of I_0 (s = 1), or their mean under that of I_s.
// Windows are cut and renormalised at the border. Radiance units.
#pragma once

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/kernels/pixel_base.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

enum class GreedyGrid {
  kAuto,  // subpixel where film positions were recorded, else pixel
  kPixel,
  kSubpixel,  // where film positions were not recorded, every cell has its pixel's mean
};
bool uses_cells(GreedyGrid grid, const SamplePool& pool);

// What every scale is computed from, per pixel.
struct LadderBase {
  RgbImage image;     // I_0
  RgbImage variance;  // of the pixel means
  Plane count;        // samples
  bool subpixel = false;
};

// I_0 and the counts that it was made of, to make it again with more samples.
struct KeptImage {
  CountImage n;
  RgbImage image;
};

// Everything known at one scale.
struct ScaleChannel {
  Plane image, variance;
};
struct Scale {
  std::array<ScaleChannel, 3> channels;
  Plane samples;  // N of the transition to this scale
};

// `before`, where not null: what was kept of fewer samples of the same pool, or nothing; it is used
// up, and changes no bit. Error kData for an empty selection.
Result<LadderBase> make_ladder_base(const PieceStatistics& statistics, const SamplePool& pool,
                                    GreedyGrid grid, const VarianceOptions& variance,
                                    double exposure, GuardCounts& guards,
                                    KeptImage* before = nullptr);

Scale base_scale(const LadderBase& base);
// beta_s; `before` is sigma_{s-1}, not used for s = 1.
double transition_beta(int s, double sigma, double before);
// The factor of z that depends on gamma alone, gamma < 0.526.
double transition_caution(double gamma);

// Adds z loss - gain of a channel to `balance`, and loss - gain to `change`, if wanted.
void add_transition(const ScaleChannel& fine, const ScaleChannel& coarse, const Plane& samples,
                    double beta, double caution, Plane& balance, Plane* change);
// Takes `scale` from s - 1 to s >= 1 of standard deviation sigma, pixels, one channel after the
// other; N of s = 1 is that of the base. Returns stop_s of every pixel, 0 or 1, before its
// neighbours are asked; `change`, if wanted, is the sum of loss - gain.
Plane climb(Scale& scale, const LadderBase& base, int s, double sigma, double beta, double caution,
            Plane* change = nullptr);

// b' of every pixel: the stop map blurred with G(sigma) * pixel filter, the pixel's own weight at
// most 0.01. Only values near 1/2 and above count as a vote to stop; a lone pixel's is 1.
Plane neighbour_votes(const Plane& stop, double sigma);
// b' rounded to the nearest; ties at straight borders must not depend on rounding.
inline bool votes_to_stop(double vote) {
  return vote + 0.5 + 1e-9 >= 1.0;
}

}  // namespace spool
