#include "lib/core/guards.h"

namespace spool {
namespace {

struct GuardText {
  std::string_view name, protects;
};

constexpr GuardText kGuardTexts[] = {
#define SPOOL_GUARD_TEXT(identifier, name, protects) {name, protects},
    SPOOL_GUARDS(SPOOL_GUARD_TEXT)
#undef SPOOL_GUARD_TEXT
};

}  // namespace

std::string_view guard_name(Guard guard) {
  return kGuardTexts[static_cast<std::size_t>(guard)].name;
}

std::string_view guard_protects(Guard guard) {
  return kGuardTexts[static_cast<std::size_t>(guard)].protects;
}

}  // namespace spool
