// Where a step of eq 9 stops: the criterion's sign, the neighbours' vote, and evidence that no vote
// overrules.
//
//   votes      stop_k blurred with a Gaussian of sigma max(0.8, 0.7 2^k). `on` stops where the
//              blurred value is at least 1/2; `opens_only` takes the piece's own vote out (all but
//              a weight of 0.01) and stops where both it and the piece's own criterion do
//   evidence   (q_{k+1} - q_k)^2 > z^2 Var(q_{k+1} - q_k): the difference is beyond z standard
//              deviations of its own noise. Such a piece stops, whatever its neighbours' vote
//
// Why a lamp stops the filter and a firefly does not: one bright sample raises the piece's own
// variance, so its difference to the neighbourhood stays near one standard deviation; a lamp raises
// every sample, so the difference is many. A variance estimated from few samples can be too small
// by chance, so the test uses at least the median variance of the 3 x 3 neighbourhood. R_{k+1} is
// not centred on the piece; the test therefore also evaluates the regions of the right, lower and
// lower-right neighbours, and uses the largest difference.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/filters/directional/options.h"

namespace spool {

// One step from a fine image of each piece to a coarser one, of one signal.
struct SizeStep {
  const Plane& fine_variance;    // S_k
  const Plane& coarse_variance;  // S_{k+1}
  const Plane& fine;             // q_k
  const Plane& coarse;           // q_{k+1}
  // Cautious forms of both variances; empty without evidence. Var(q_{k+1} - q_k) = that of q_{k+1}
  // + own_share that of q_k, 1 - 2 q_k's share of q_{k+1}.
  const Plane& fine_noise;
  const Plane& coarse_noise;
  double own_share = 0.5;
  bool regions = true;  // q_{k+1} is of the region R_{k+1}, which has no middle piece
};

// Each variance, but at least the median of those of the piece and its eight neighbours.
Plane cautious_variance(const Plane& variance);

// What the signals together say of a step.
struct SizeCriterion {
  Plane t;       // T_k, the signals' mean
  Plane beyond;  // sum of (q_{k+1} - q_k)^2 - z^2 Var; empty without evidence
};

// Adds what a signal says, over `signals` of them [LiuZheng (9)].
void add_step(const SizeStep& step, const Plane& w, std::size_t signals, double evidence,
              SizeCriterion& criterion);

// Adds to `beyond` the largest (q_{k+1} - q_k)^2 - bound Var over the regions that touch the piece.
void add_evidence(const SizeStep& step, double bound, Plane& beyond);

// 1 where the size stops, else 0; k = -1 is the step to the base image.
Plane decide_stops(const SizeCriterion& criterion, int k, SizeSmooth rule, GuardCounts& guards);

}  // namespace spool
