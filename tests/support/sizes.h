// The sizes over which kernels are compared with their slow twins.
#pragma once

#include <utility>
#include <vector>

namespace spool::test {

// Every width and height from 1 to 17, 31 and 64; few pixels, as twins are slow.
inline std::vector<std::pair<int, int>> twin_sizes() {
  std::vector<std::pair<int, int>> sizes;
  for (int i = 1; i <= 17; ++i)
    sizes.emplace_back(i, 18 - i);
  sizes.insert(sizes.end(), {{1, 1}, {31, 5}, {6, 31}, {64, 4}});
  return sizes;
}

}  // namespace spool::test
