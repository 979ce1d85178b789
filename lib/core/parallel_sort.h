// Sorting by several threads into an order that does not depend on how many they are.
#pragma once

#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

namespace spool {

// `before` must distinguish any two elements, NaN too: there is then one sorted order, whatever
// sorts. Work that is stopped meanwhile sorts to the end: half an order is none.
template <class Value, class Before>
void parallel_sort(std::vector<Value>& values, Before&& before) {
  using oneapi::tbb::task_group_context;
  task_group_context alone(task_group_context::isolated);
  oneapi::tbb::parallel_for(
      0, 1, [&](int) { oneapi::tbb::parallel_sort(values.begin(), values.end(), before); }, alone);
}

}  // namespace spool
