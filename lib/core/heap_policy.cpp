#include "lib/core/heap_policy.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace spool {

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kKept = 1 << 30;  // at the end of the heap
  mallopt(M_MMAP_MAX, 0);         // no block of its own for a large image
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

}  // namespace spool
