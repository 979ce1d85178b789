#include "lib/statistics/window_sums.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr int kLanes = 32;  // columns that are summed at once: going from row to row is slow
using Lanes = std::array<double, kLanes>;

Lanes operator+(const Lanes& a, const Lanes& b) {
  Lanes sum;
  for (std::size_t l = 0; l < kLanes; ++l)
    sum[l] = a[l] + b[l];
  return sum;
}

// line[x] becomes the sum of line[x - radius .. x + radius].
template <class Value>
void sum_line(std::span<Value> line, int radius) {
  const auto r = static_cast<std::size_t>(radius), length = 2 * r + 1;
  const std::size_t padded = line.size() + 2 * r;
  // from_begin[k]: padded values from the beginning of k's block to k; to_end[k]: from k to its
  // end.
  std::vector<Value> from_begin(padded, Value{}), to_end;
  std::copy(line.begin(), line.end(), from_begin.begin() + radius);
  to_end = from_begin;
  for (std::size_t begin = 0; begin < padded; begin += length) {
    const std::size_t end = std::min(begin + length, padded);
    for (std::size_t k = begin + 1; k < end; ++k)
      from_begin[k] = from_begin[k - 1] + from_begin[k];
    for (std::size_t k = end - 1; k-- > begin;)
      to_end[k] = to_end[k] + to_end[k + 1];
  }
  for (std::size_t begin = 0; begin < line.size(); begin += length) {
    const std::size_t end = std::min(begin + length, line.size());
    line[begin] = to_end[begin];  // the window is the block
    for (std::size_t x = begin + 1; x < end; ++x)
      line[x] = to_end[x] + from_begin[x + 2 * r];
  }
}

}  // namespace

Plane window_sums(Plane out, int radius) {
  SPOOL_CHECK_GE(radius, 0);
  // Beyond the image there is nothing to add.
  const int across = std::min(radius, out.width()), down = std::min(radius, out.height());
  parallel_rows(0, out.height(), [&](int y) { sum_line(out.row(y), across); });
  parallel_rows(0, (out.width() + kLanes - 1) / kLanes, [&](int strip) {
    const int x0 = strip * kLanes, x1 = std::min(x0 + kLanes, out.width());
    std::vector<Lanes> columns(static_cast<std::size_t>(out.height()), Lanes{});
    for (int y = 0; y < out.height(); ++y)
      std::copy_n(&out(x0, y), x1 - x0, columns[static_cast<std::size_t>(y)].begin());
    sum_line(std::span(columns), down);
    for (int y = 0; y < out.height(); ++y)
      std::copy_n(columns[static_cast<std::size_t>(y)].begin(), x1 - x0, &out(x0, y));
  });
  return out;
}

}  // namespace spool
