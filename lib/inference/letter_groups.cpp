#include "lib/inference/letter_groups.h"

#include <algorithm>
#include <numeric>

namespace spool {
namespace {

using Items = std::vector<std::size_t>;  // ascending
using Adjacency = std::vector<std::vector<bool>>;

constexpr std::size_t kMostGroups = 20000;  // there may be exponentially many

Items neighbours_in(const Adjacency& alike, std::size_t item, const Items& items) {
  Items found;
  for (const std::size_t other : items) {
    if (alike[item][other]) found.push_back(other);
  }
  return found;
}

// Maximal cliques by Bron and Kerbosch's search with a pivot [BronKerbosch73].
class Cliques {
 public:
  explicit Cliques(const Adjacency& alike) : alike_(alike) {}

  std::vector<Items> all() {
    Items every(alike_.size());
    std::iota(every.begin(), every.end(), std::size_t{0});
    extend({}, every, {});
    return found_;
  }

 private:
  void extend(const Items& clique, Items open, Items closed) {
    if (found_.size() > kMostGroups) return;
    if (open.empty() && closed.empty()) {
      found_.push_back(clique);
      std::ranges::sort(found_.back());
      return;
    }
    const std::size_t pivot = best_pivot(open, closed);
    const Items candidates = open;
    for (const std::size_t item : candidates) {
      if (alike_[pivot][item]) continue;
      Items grown = clique;
      grown.push_back(item);
      extend(grown, neighbours_in(alike_, item, open), neighbours_in(alike_, item, closed));
      std::erase(open, item);
      closed.push_back(item);
    }
  }

  std::size_t best_pivot(const Items& open, const Items& closed) const {
    std::size_t best = open.empty() ? closed.front() : open.front(), most = 0;
    for (const Items* items : {&open, &closed}) {
      for (const std::size_t item : *items) {
        const std::size_t reached = neighbours_in(alike_, item, open).size();
        if (reached > most) best = item, most = reached;
      }
    }
    return best;
  }

  const Adjacency& alike_;
  std::vector<Items> found_;
};

// Leaves out sets whose pairs other sets show too, small sets first.
void drop_redundant(std::vector<Items>& groups, std::size_t count) {
  std::vector<std::vector<int>> shown(count, std::vector<int>(count, 0));
  const auto count_pairs = [&](const Items& group, int step) {
    for (const std::size_t i : group) {
      for (const std::size_t j : group)
        shown[i][j] += step;
    }
  };
  for (const Items& group : groups)
    count_pairs(group, 1);
  std::ranges::stable_sort(groups, {}, [](const Items& group) { return group.size(); });
  std::erase_if(groups, [&](const Items& group) {
    for (const std::size_t i : group) {
      for (const std::size_t j : group) {
        if (shown[i][j] < 2) return false;
      }
    }
    count_pairs(group, -1);
    return true;
  });
}

// a .. z, then a1 .. z1, ...
std::string letter(std::size_t index) {
  std::string text(1, static_cast<char>('a' + index % 26));
  return index < 26 ? text : text + std::to_string(index / 26);
}

}  // namespace

std::vector<std::string> letter_groups(std::size_t count,
                                       const std::function<bool(std::size_t, std::size_t)>& apart) {
  Adjacency alike(count, std::vector<bool>(count, false));
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < j; ++i)
      alike[i][j] = alike[j][i] = !apart(i, j);
  }
  std::vector<std::string> letters(count);
  std::vector<Items> groups = Cliques(alike).all();
  if (groups.size() > kMostGroups) return letters;
  drop_redundant(groups, count);
  std::ranges::sort(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const std::size_t item : groups[g])
      letters[item] += letter(g);
  }
  return letters;
}

}  // namespace spool
