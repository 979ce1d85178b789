#include "lib/sampling/neyman.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/sampling/rounds.h"
#include "lib/sampling/spending.h"

namespace spool {
namespace {

Plane pool_deviation(const SamplePool& pool) {
  Plane deviation(pool.width(), pool.height());
  parallel_rows(0, pool.height(), [&](int y) {
    for (int x = 0; x < pool.width(); ++x) {
      const int count = pool.size(x, y);
      std::array<double, 3> mean{}, m2{};
      for (int s = 0; s < count; ++s) {
        const Rgb value = pool.sample(x, y, s);
        for (std::size_t c = 0; c < 3; ++c) {
          const double delta = value[c] - mean[c];
          mean[c] += delta / (s + 1);
          m2[c] += delta * (value[c] - mean[c]);
        }
      }
      if (count > 1) deviation(x, y) = std::sqrt((m2[0] + m2[1] + m2[2]) / (3.0 * (count - 1)));
    }
  });
  return deviation;
}

}  // namespace

const OptionTable<NeymanOptions>& neyman_option_table() {
  using O = NeymanOptions;
  static const OptionTable<O> table = {
      integer_option<O>("init_spp", &O::init_spp, 1, 65535, "least samples of a piece"),
  };
  return table;
}

Result<SamplingResult> sample_neyman(const SamplePool& pool, long long budget,
                                     const NeymanOptions& options, const SamplingContext& context) {
  CountImage n = initial_counts(pool, budget, options.init_spp, context.seed);
  const long long initial = count_samples(n);
  const Plane deviation = pool_deviation(pool);
  const CountImage none(pool.width(), pool.height());
  const CountImage ideal = hand_out(deviation, none, pool, budget);
  Plane missing(n.width(), n.height());
  for (std::size_t i = 0; i < n.size(); ++i)
    missing[i] = std::max(ideal[i] - n[i], 0);
  const long long left = std::min(budget, pool.total_capacity()) - initial;
  const CountImage extra = hand_out(missing, n, pool, left);
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] += extra[i];
  if (context.views != nullptr) context.views->add("deviation", deviation);
  Spending spending = begin_spending(pool, budget, n);
  spending.log.initial = initial;
  SPOOL_TRY(report_progress(context, "neyman", budget, budget));
  return end_spending(std::move(spending), pool);
}

Sampler neyman_sampler() {
  return make_value<SamplerFunction, NeymanOptions>(
      {.name = "neyman",
       .summary = "oracle: by the deviation of everything recorded",
       .options = neyman_option_table(),
       .views = {{"deviation", "deviation of everything recorded"}},
       .memory = {156, 2e6},
       .run = sample_neyman});
}

}  // namespace spool
