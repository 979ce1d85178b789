// Non-local means between two halves of the samples [RousselleKnausZwicker12].
//
// Halves A and B hold the even and the odd samples of each piece. Weights come from one half and
// filter the other:
//   d2(p, q) = mean over channels of ((a_p - a_q)^2 - alpha (v_p + min(v_q, v_p)))
//              / (1e-10 + kappa^2 (v_p + v_q))
//   w = box(exp(-max(0, box(d2)))) with boxes over the patch of (2 f + 1)^2, 0 below 0.05, and 1 at
//   the centre; F_A(p) = sum of w a_q / sum of w over |q - p| <= r in x and y
// a, v: means and variances of the mean of a half, exposed. The result is the mean of F_A and F_B
// by sample counts. Borders are mirrored. A half without samples is filled from its neighbours.
// Arithmetic is double; one offset after the other, so bits do not depend on threads.
// Slow twin: tests/reference/nl_means_reference.h.
#pragma once

#include "lib/reconstruction/reconstructor_entry.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

struct NlMeansOptions {
  int window = 10;  // r, pieces
  int patch = 3;    // f
  double kappa = 0.45;
  double alpha = 1.0;
  // A half of few samples often has variance 0 by chance, and distances are divided by it.
  VarianceMode var_mode = VarianceMode::kPooled;
  double nu0 = 2.0;
  double key = 1.0;
};

OptionTable<NlMeansOptions> nl_means_option_table();

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const ReconstructionContext& context,
                                            const NlMeansOptions& options);

// One half as NL-means sees it; exposed, or in any unit with the same epsilon.
struct HalfImage {
  RgbImage mean, variance;
};

// `target` filtered with weights from `guide`; both [c][y][x].
RgbImage filter_with_guide(const RgbImage& target, const HalfImage& guide,
                           const NlMeansOptions& options);

ReconstructorMethod<NlMeansOptions> nl_means_method();

}  // namespace spool
