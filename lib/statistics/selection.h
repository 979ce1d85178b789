// What a sampler hands to a filter: the statistics of every prefix it took, and the
// attenuation of each level where it kept one.
//
// A replay always takes a prefix of each pool, so the counts say everything: statistics can be
// recomputed from pool and counts, and any sampler can take part by writing a count image.
#pragma once

#include <vector>

#include "lib/core/image.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

// What is made of the halves of a selection.
enum class HalvesUse {
  kApart,     // two images, which are averaged (lib/experiment/decision_split.h)
  kTogether,  // one image of the samples of both (joined_halves.h)
};

struct Selection {
  PieceStatistics statistics;
  std::vector<Plane> attenuation;  // A_0 .. A_K [y][x], or empty when the sampler keeps none
  // Where the even samples decided about the odd ones and the other way round: what is taken of
  // pool.half(0) and of pool.half(1). Empty otherwise.
  std::vector<Selection> halves = {};
  HalvesUse halves_use = HalvesUse::kApart;
};

}  // namespace spool
