// What samplers that work in rounds share: the first samples of every piece, equal shares of the
// rest, and handing a share out over an image of weights.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/sampling/spending.h"

namespace spool {

// Samples that every piece takes first, unless an option says how many: 4 from 8 samples per piece
// on, else 2; 1 where a pixel has several pieces and 2 would leave nothing to decide about.
int default_initial_samples(long long budget, const SamplePool& pool);

// The counts after every piece took up to `each` samples, or, where the budget ends before, after a
// uniform spread of it.
CountImage initial_counts(const SamplePool& pool, long long budget, int each, std::uint64_t seed);

// `total` in `rounds` whole shares that differ by at most one, the larger first.
std::vector<long long> equal_shares(long long total, int rounds);

// What every piece has left.
std::vector<long long> room_of(const CountImage& n, const SamplePool& pool);

// Whether weights decide anything: one of them is above 0.
bool decide(const Plane& weights);

// Apportions `share` over the pieces in proportion to `weights` (NaN and negative count as 0), no
// piece beyond its capacity: samples to take per piece, in all min(share, what is left).
CountImage hand_out(const Plane& weights, const CountImage& n, const SamplePool& pool,
                    long long share);

// Spends what is left in equal shares: `choose` says where each goes, by what was taken before. An
// empty image: nothing decides, and the pieces with the fewest samples get them, counted.
Result<void> spend_in_rounds(Spending& spending, const SamplePool& pool, int rounds,
                             std::string_view sampler, const SamplingContext& context,
                             const std::function<Result<CountImage>(long long share)>& choose);

template <class Options>
Option<Options> init_spp_option(std::optional<int> Options::* member) {
  return integer_or_word_option<Options>(
      "init_spp", member, "auto", 1, 65535,
      "samples that every piece takes first; auto: 4 from 8 samples per piece on, else 2");
}

}  // namespace spool
