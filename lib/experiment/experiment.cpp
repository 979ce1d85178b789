#include "lib/experiment/experiment.h"

#include <array>

namespace spool {

std::string_view order_name(ReplicateOrder order) {
  constexpr std::array<std::string_view, 3> kNames = {"recorded", "shuffled", "disjoint"};
  return kNames[static_cast<std::size_t>(order)];
}

}  // namespace spool
