// Options of the filter twin_guides and what they are measured in.
//
// Radiance-scaled constants are multiples of L, the scene's luminance
// (lib/kernels/scene_luminance.h). docs/twin_guides.md says what each option means.
#pragma once

#include <optional>

#include "lib/core/guards.h"
#include "lib/core/option_table.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

struct TwinGuidesOptions {
  std::optional<int> scales;  // the taps of scale k stand 2^k pieces apart; none: scale_count
  int radius = 6;             // of the window, pieces
  double sigma = 4.0;         // of the window's Gaussian, pieces
  double guide_sigma = 0.5;   // of the finer pyramid level, pieces; the coarser has twice that
  double stretch = 2.0;       // of the coarser level along the structure of the picture; 0: round
  double slack = 1.5;         // factor on the estimated noise of the guides
  double small_slack = 4.0;   // the same of noise below small_noise
  double small_noise = 0.25;  // standard deviation of a sample's logarithm
  double detail_slack = 1.6;  // factor on the estimated noise of a scale's detail
  double tau = 0.10;          // difference of logarithms that separates two pieces
  double feature_gain = 0.1;  // weight of the distance of features
  double cut = 4.0;           // distance at which a weight is 0
  double ridge = 0.05;        // on every coefficient of the fit but the constant
  double clamp_sigma = 8.0;   // neighbourhood that says what a sample may be, pixels
  double agreement = 16.0;    // reach of the light that samples agree on, pieces; 0: none returns
  double heavy = 0.12;        // agreed light over kept light of heavy tails; 0: any
  double opening = 8.0;       // of the clamp where tails are heavy; 0: none
  int noise_pool = 8;         // largest radius of the pool of a variance there, pieces; 0: none
  double limit = 20.0;        // of a piece's luminance, times what its window says
};

// For pictures most of whose light few samples carry everywhere; elsewhere it costs.
TwinGuidesOptions heavy_tailed_twin_guides_options();

OptionTable<TwinGuidesOptions> twin_guides_option_table();

// Scales of a picture of so many pieces. Without a number in `options` the reach of the coarsest
// window is a tenth of the picture's smaller side: 3 scales, 4 from 363 pieces on.
int scale_count(const TwinGuidesOptions& options, int width, int height);

// What the specification of the filter fixes.
inline constexpr double kLogFloor = 0.10;    // log(max(x, 0) + kLogFloor L) of a sample
inline constexpr double kPilotFloor = 0.05;  // log(max(P, 0) + kPilotFloor L) of the pilot
// What a tap of the next scale reads is a mean over four times as much, of a quarter of the noise.
inline constexpr double kRidgeOfCoarser = 0.25;

// Everything is computed on radiance * unit, which is near 1 and may be float. The unit is a power
// of two: it costs no digit, and a recording twice as bright gives the same bits.
struct RadianceScale {
  double unit = 1.0;
  double mean = 1.0;  // L * unit, 1 .. 2
};

RadianceScale radiance_scale(const PieceStatistics& statistics, GuardCounts& guards);

}  // namespace spool
