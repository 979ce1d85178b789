// Limits for single samples: what the samples around a pixel, and its own others, make believable.
//
// n_p samples of pixel p, L their luminance, U the scene's luminance (scene_luminance.h):
//
//   group k = the samples of p at positions k, k + m, k + 2 m, ...,   m = min(4, smallest n_p > 0)
//   around  = median over k of G_sigma * (mean L of group k)
//   own     = (sum L - max L) / max(n_p - 1, 1)
//   T_p     = max(kappa, n_p) max(around, own, 0) + floor U
//
// A sample with L > T_p is scaled down to T_p, all channels alike. One sample far above the others
// spoils one group of four, which a median does not follow; and what `own` says again is light.
// The factor grows with n_p, so that the mean of clamped samples tends to the mean of all. A clamp
// takes light away, mostly from rare bright paths: the energy step (energy_step.h) can give it
// back. The Gaussian is cut at 4 sigma and mirrored at the border. With several pieces to a pixel
// the positions run through the pieces row by row. Slow twin:
// tests/reference/sample_clamp_reference.h.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

struct SampleClampOptions {
  double kappa = 16.0;   // least multiple of what is expected that a sample may be
  double sigma = 2.0;    // of the neighbourhood, pixels
  double floor = 0.005;  // allowed everywhere, in units of the scene's luminance
};

inline constexpr int kMostSampleGroups = 4;

// Sums over the q x q pieces of each pixel.
CountImage samples_of_pixels(const CountImage& n, int q);

// m: min(4, smallest count of one that has samples), of pixels or of pieces.
int number_of_groups(const CountImage& n);

// T [y][x] of pixels, radiance units, from the first n(x, y) samples of every piece; a pixel
// without samples takes part with its neighbours' values. `unit` is the scene's luminance, > 0.
Plane sample_limits(const SamplePool& pool, const CountImage& n, double unit,
                    const SampleClampOptions& options = {});

struct ClampedSamples {
  SamplePool pool;      // hands out clamped samples
  Selection selection;  // the same counts, with the statistics of clamped samples
};

// What a filter gets when samples are clamped before it. `guards` counts the samples scaled down.
// Of halves that are used together the pool is pool_of_joined(); halves that are apart are clamped
// each.
ClampedSamples clamp_samples(const Selection& selection, const SamplePool& pool,
                             const SampleClampOptions& options, GuardCounts& guards);

}  // namespace spool
