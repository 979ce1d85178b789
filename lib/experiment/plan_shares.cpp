#include "lib/experiment/plan_shares.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "lib/core/check.h"

namespace spool {
namespace {

// Shares first .. end - 1, which a recording's runs may go to.
struct Interval {
  int first = 0, end = 0;
};

struct Load {
  double total = 0.0, largest = 0.0;
  std::vector<std::string> dumps;  // in the order of the runs
  std::map<std::string, double> of_dump;

  explicit Load(const std::vector<PlannedRun>& runs) {
    for (const PlannedRun& run : runs) {
      total += run.cost;
      largest = std::max(largest, run.cost);
      if (of_dump.emplace(run.dump, 0.0).second) dumps.push_back(run.dump);
      of_dump[run.dump] += run.cost;
    }
  }
  double best(int shares) const { return std::max(largest, total / shares); }
};

// Recordings one behind the other along the shares, each widened by `slack` shares on both sides.
std::map<std::string, Interval> intervals(const Load& load, int shares, int slack) {
  std::map<std::string, Interval> found;
  double before = 0.0;
  for (const std::string& dump : load.dumps) {
    const double after = before + load.of_dump.at(dump);
    const double per_share = load.total / shares;
    const int first = static_cast<int>(std::floor(before / per_share));
    const int end = static_cast<int>(std::ceil(after / per_share));
    Interval& interval = found[dump];
    interval.first = std::clamp(first - slack, 0, shares - 1);
    interval.end = std::clamp(end + slack, interval.first + 1, shares);
    before = after;
  }
  return found;
}

}  // namespace

std::vector<PlannedRun> sampling_runs(const std::vector<Cell>& cells) {
  std::vector<PlannedRun> runs;
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [place, fresh] = known.try_emplace(sampling_key(cells[i]), runs.size());
    if (fresh) runs.push_back({cells[i].dump, {}, 0.0});
    runs[place->second].cells.push_back(i);
  }
  return runs;
}

std::vector<int> balanced_shares(const std::vector<PlannedRun>& runs, int shares) {
  SPOOL_CHECK_GT(shares, 0);
  const Load load(runs);
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return runs[a].cost > runs[b].cost; });
  std::vector<int> share_of(runs.size(), 0);
  for (int slack = 0;; slack = 2 * slack + 1) {
    const auto allowed = intervals(load, shares, slack);
    std::vector<double> loads(static_cast<std::size_t>(shares), 0.0);
    for (const std::size_t i : order) {
      const Interval& interval = allowed.at(runs[i].dump);
      const auto least =
          std::min_element(loads.begin() + interval.first, loads.begin() + interval.end);
      *least += runs[i].cost;
      share_of[i] = static_cast<int>(least - loads.begin());
    }
    if (slack >= shares || std::ranges::max(loads) <= kMostUneven * load.best(shares)) {
      return share_of;
    }
  }
}

}  // namespace spool
