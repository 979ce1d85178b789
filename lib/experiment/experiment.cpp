#include "lib/experiment/experiment.h"

namespace spool {

std::string_view order_name(ReplicateOrder order) {
  switch (order) {
    case ReplicateOrder::kRecorded:
      return "recorded";
    case ReplicateOrder::kShuffled:
      return "shuffled";
    case ReplicateOrder::kDisjoint:
      return "disjoint";
  }
  return "";
}

}  // namespace spool
