#include "lib/sampling/mitchell.h"

#include <algorithm>
#include <array>
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

// max_c C_c / tau_c of every piece, over the window.
Plane contrast_ratio(const PieceStatistics& statistics, const Thresholds& tau, int window) {
  const int reach = window / 2;
  const double exposure = statistics.signal.exposure;
  Plane ratio(statistics.width(), statistics.height());
  parallel_rows(0, ratio.height(), [&](int y) {
    for (int x = 0; x < ratio.width(); ++x) {
      const Rectangle around =
          intersect({x - reach, y - reach, x + reach + 1, y + reach + 1}, ratio.bounds());
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
                        const std::vector<int>& room, CountImage& extra) {
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

std::vector<int> room_of(const CountImage& n, const SamplePool& pool) {
  std::vector<int> room(n.size());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      room[n.index(x, y)] = pool.capacity(x, y) - n(x, y);
  }
  return room;
}

Result<void> run_rounds(Spending& spending, const SamplePool& pool, const Thresholds& tau,
                        const MitchellOptions& options, const SamplingContext& context) {
  const auto choose = [&](long long share) -> Result<CountImage> {
    const PieceStatistics& statistics = spending.statistics;
    const Plane ratio = contrast_ratio(statistics, tau, options.window);
    const std::vector<int> room = room_of(statistics.n, pool);
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
      const long long used = give_in_order(order, options.per, share, room, extra);
      if (used == 0) break;  // all saturated
      share -= used;
    }
    return extra;
  };
  return spend_in_rounds(spending, pool, options.rounds, "mitchell", context, choose);
}

// The two-level modes: one look at the base samples, one hand-out.
void run_two_levels(Spending& spending, const SamplePool& pool, const Thresholds& tau,
                    const MitchellOptions& options) {
  const PieceStatistics& statistics = spending.statistics;
  long long left = spending.left;
  const Plane ratio = contrast_ratio(statistics, tau, options.window);
  const std::vector<int> room = room_of(statistics.n, pool);
  const bool only_flagged = options.mode == MitchellMode::kTwoLevel;
  std::vector<Turn> turns;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    if (!only_flagged || ratio[i] > 1.0)
      turns.push_back({0, static_cast<std::uint32_t>(i), ratio[i]});
  }
  const std::vector<Turn> order = in_order(std::move(turns));
  CountImage extra(ratio.width(), ratio.height());
  const int per = std::max(options.n_high - options.n_base, 1);
  if (only_flagged) {
    give_in_order(order, per, left, room, extra);
  } else {
    const auto pieces = static_cast<long long>(order.size());
    const long long raised = std::max<long long>(per, (left + pieces - 1) / pieces);
    while (left > 0) {  // again only for the shares of saturated pieces
      const long long used = give_in_order(order, static_cast<int>(raised), left, room, extra);
      if (used == 0) break;
      left -= used;
    }
  }
  spend(spending, pool, extra);
}

}  // namespace

const OptionTable<MitchellOptions>& mitchell_option_table() {
  using O = MitchellOptions;
  static const OptionTable<O> table = {
      choice_option<O, MitchellMode>("mode", &O::mode,
                                     {{"multi_round", MitchellMode::kMultiRound},
                                      {"two_level_budget", MitchellMode::kTwoLevelBudget},
                                      {"two_level", MitchellMode::kTwoLevel}},
                                     "rounds, or two levels that meet the budget or do not"),
      init_spp_option<O>(&O::init_spp),
      integer_option<O>("n_base", &O::n_base, 1, 65535, "first samples of the two-level modes"),
      integer_option<O>("n_high", &O::n_high, 1, 65535,
                        "samples of a flagged pixel in the two-level modes"),
      integer_option<O>("rounds", &O::rounds, 1, 1000, "rounds of multi_round"),
      integer_option<O>("per", &O::per, 1, 65535, "samples of a pixel and round in multi_round"),
      {"window", "3|1", "pixels per side over which contrast is taken",
       [](O& options, std::string_view text) -> Result<void> {
         SPOOL_ASSIGN(const int value, parse_integer("window", text, 1, 3));
         if (value == 2) return fail(ErrorCode::kUsage, "option window: 2 is not 3 or 1");
         options.window = value;
         return {};
       },
       [](const O& options) { return std::to_string(options.window); }},
      number_option<O>("tau_red", &O::tau_red, 1e-6, 1e6, "threshold of the red contrast"),
      number_option<O>("tau_green", &O::tau_green, 1e-6, 1e6, "threshold of the green contrast"),
      number_option<O>("tau_blue", &O::tau_blue, 1e-6, 1e6, "threshold of the blue contrast"),
      number_option<O>("tau_grey", &O::tau_grey, 1e-6, 1e6, "threshold where all samples are grey"),
      number_option<O>("key", &O::key, 1e-6, 1e6, "mean of the normalised luminance"),
  };
  return table;
}

Result<SamplingResult> sample_mitchell(const SamplePool& pool, long long budget,
                                       const MitchellOptions& options,
                                       const SamplingContext& context) {
  const bool rounds = options.mode == MitchellMode::kMultiRound;
  const int each =
      rounds ? options.init_spp.value_or(default_initial_samples(budget, pool)) : options.n_base;
  Spending spending = begin_spending(pool, budget, initial_counts(pool, budget, each, context.seed),
                                     options.key, ChannelRange::kKept);
  const Thresholds tau = is_grey(spending.statistics)
                             ? Thresholds{options.tau_grey, options.tau_grey, options.tau_grey}
                             : Thresholds{options.tau_red, options.tau_green, options.tau_blue};
  if (rounds) {
    SPOOL_TRY(run_rounds(spending, pool, tau, options, context));
  } else {
    run_two_levels(spending, pool, tau, options);
  }
  if (context.views != nullptr && context.views->wants("ratio")) {
    context.views->add("ratio", contrast_ratio(spending.statistics, tau, options.window));
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
       .run = sample_mitchell});
}

}  // namespace spool
