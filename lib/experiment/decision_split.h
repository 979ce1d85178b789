// Samples that decide are not averaged: the cure for what adaptive sampling does to rare bright
// events, at the price of more noise. A diagnostic, not a default.
//
// The even samples of every piece and the odd ones are two pools. A sampler runs on each with half
// of the budget; the counts that it chooses from one are what is averaged of the other, and the
// image is the mean of the two. A count and the samples under it are then independent, so the mean
// over them is unbiased, which the ordinary adaptive mean is not (docs/method.md).
#pragma once

#include "lib/filters/filter.h"
#include "lib/sampling/sampler.h"

namespace spool {

// The sampler that decides so. The selection's halves say what is averaged; its statistics are
// those of the shortest prefixes that hold every sample decided or averaged by, which `spent`
// counts: more than the budget, as the two runs ask for different pieces. A half that is shorter
// than the other one chooses is averaged as far as it goes.
ReadySampler split_decisions(ReadySampler sampler);

// The filter for selections with halves. Where they are used apart: the mean of the two images, a
// quarter of the sum of their variances, level and direction of the even one. Where they are used
// together: the image of the samples of both. Other selections pass unchanged.
ReadyFilter average_halves(ReadyFilter filter);

}  // namespace spool
