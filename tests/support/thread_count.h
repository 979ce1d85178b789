// Runs a function with a given number of threads, more than the machine has cores if need be.
//
// ThreadLimit alone only lowers the number: loops of the calling thread never use more threads than
// there are cores.
#pragma once

#include <oneapi/tbb/task_arena.h>

#include "lib/core/parallel.h"

namespace spool::test {

template <class Function>
auto with_threads(int threads, Function&& function) {
  const ThreadLimit limit(threads);
  oneapi::tbb::task_arena arena(threads);
  return arena.execute(function);
}

}  // namespace spool::test
