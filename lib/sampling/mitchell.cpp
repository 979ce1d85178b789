#include "lib/sampling/mitchell.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/core/parallel_sort.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/contrast.h"

namespace spool {
namespace {

using Thresholds = std::array<double, 3>;

bool is_grey(const PieceStatistics& statistics) {
  return statistics.mean[0] == statistics.mean[1] && statistics.mean[1] == statistics.mean[2];
}

// max_c C_c / tau_c of every piece, over its 3 x 3 neighbourhood.
Plane contrast_ratio(const PieceStatistics& statistics, const Thresholds& tau) {
  const double exposure = statistics.signal.exposure;
  Plane ratio(statistics.width(), statistics.height());
  parallel_rows(0, ratio.height(), [&](int y) {
    for (int x = 0; x < ratio.width(); ++x) {
      const Rectangle around = intersect({x - 1, y - 1, x + 2, y + 2}, ratio.bounds());
      double largest = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        const Plane& lows = (*statistics.channel_minimum)[c];
        const Plane& highs = (*statistics.channel_maximum)[c];
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (int v = around.y0; v < around.y1; ++v) {
          for (int u = around.x0; u < around.x1; ++u) {
            low = std::min(low, lows(u, v));
            high = std::max(high, highs(u, v));
          }
        }
        if (low > high) continue;  // no sample in the window
        low *= exposure, high *= exposure;
        const double contrast = (high - low) / (std::abs(high) + std::abs(low) + kContrastEpsilon);
        largest = std::max(largest, contrast / tau[c]);
      }
      ratio(x, y) = largest;
    }
  });
  return ratio;
}

// A piece in the order in which samples are handed out.
struct Turn {
  std::int32_t group;  // lower is earlier
  std::uint32_t piece;
  double ratio;  // within a group larger is earlier, and of equal ones the first of the image
};

std::vector<Turn> in_order(std::vector<Turn> turns) {
  parallel_sort(turns, [](const Turn& a, const Turn& b) {
    return std::tuple(a.group, -a.ratio, a.piece) < std::tuple(b.group, -b.ratio, b.piece);
  });
  return turns;
}

// Gives `most` samples to each piece in `order` until `share` is used; what is used.
long long give_in_order(const std::vector<Turn>& order, int most, long long share,
                        const std::vector<long long>& room, CountImage& extra) {
  long long used = 0;
  for (const Turn& turn : order) {
    const std::size_t i = turn.piece;
    if (used == share) break;
    const auto add = std::min<long long>({most, room[i] - extra[i], share - used});
    extra[i] += static_cast<std::int32_t>(add);
    used += add;
  }
  return used;
}

Result<void> run_rounds(Spending& spending, const SamplePool& pool, const Thresholds& tau,
                        const MitchellOptions& options, const SamplingContext& context) {
  const auto choose = [&](long long share) -> Result<CountImage> {
    const PieceStatistics& statistics = spending.statistics;
    const Plane ratio = contrast_ratio(statistics, tau);
    const std::vector<long long> room = room_of(statistics.n, pool);
    // Flagged first, least-sampled first, largest ratio first; where nothing is flagged the largest
    // ratio alone decides.
    constexpr std::int32_t kNotFlagged = std::numeric_limits<std::int32_t>::max();
    std::vector<Turn> turns(ratio.size());
    parallel_for(turns.size(), [&](std::size_t i) {
      turns[i] = {ratio[i] > 1.0 ? statistics.n[i] : kNotFlagged, static_cast<std::uint32_t>(i),
                  ratio[i]};
    });
    const std::vector<Turn> order = in_order(std::move(turns));
    CountImage extra(ratio.width(), ratio.height());
    while (share > 0) {  // a second pass only when every piece had its turn
      const long long used = give_in_order(order, kMitchellTurn, share, room, extra);
      if (used == 0) break;  // all saturated
      share -= used;
    }
    return extra;
  };
  return spend_in_rounds(spending, pool, options.rounds, "mitchell", context, choose);
}

}  // namespace

const OptionTable<MitchellOptions>& mitchell_option_table() {
  using O = MitchellOptions;
  static const OptionTable<O> table = {
      init_spp_option<O>(&O::init_spp),
      integer_option<O>("rounds", &O::rounds, 1, 1000, "rounds that share the rest"),
  };
  return table;
}

Result<SamplingResult> sample_mitchell(const SamplePool& pool, long long budget,
                                       const MitchellOptions& options,
                                       const SamplingContext& context) {
  const int each = options.init_spp.value_or(default_initial_samples(budget, pool));
  Spending spending = begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed),
                                     ChannelRange::kKept);
  const Thresholds& tau =
      is_grey(spending.statistics) ? kMitchellGreyThresholds : kMitchellThresholds;
  SPOOL_TRY(run_rounds(spending, pool, tau, options, context));
  if (context.views != nullptr && context.views->wants("ratio")) {
    context.views->add("ratio", contrast_ratio(spending.statistics, tau));
  }
  SPOOL_TRY(report_progress(context, "mitchell", budget, budget));
  return end_spending(std::move(spending), pool);
}

Sampler mitchell_sampler() {
  return make_value<SamplerFunction, MitchellOptions>(
      {.name = "mitchell",
       .summary = "pixels whose neighbourhood has a high contrast",
       .source = Source::kDescriptions,
       .options = mitchell_option_table(),
       .views = {{"ratio", "largest contrast over its threshold, at the end"}},
       .memory = {172, 2e6},
       .cost = 1.16,
       .run = sample_mitchell});
}

}  // namespace spool
