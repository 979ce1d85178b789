// Sorting by several threads into an order that does not depend on how many they are.
#pragma once

#include <vector>

#include <oneapi/tbb/parallel_sort.h>

namespace spool {

// `before` must tell any two elements apart: there is then one sorted order, whoever sorts.
template <class Value, class Before>
void parallel_sort(std::vector<Value>& values, Before&& before) {
  oneapi::tbb::parallel_sort(values.begin(), values.end(), before);
}

}  // namespace spool
