#include "lib/statistics/block_jump.h"

#include <cmath>
#include <cstdlib>

#include "lib/core/check.h"

namespace spool {
namespace {

struct Jumps {
  double sum = 0.0;
  double neighbours = 0.0;

  void add(int a, int b) {
    sum += std::abs(static_cast<double>(a) - b);
    neighbours += 1.0;
  }
};

}  // namespace

double block_jump(const Image<int>& counts, int step) {
  SPOOL_CHECK_GE(step, 1);
  Jumps border, elsewhere;
  for (int y = 0; y < counts.height(); ++y) {
    for (int x = 0; x < counts.width(); ++x) {
      if (x > 0) (x % step == 0 ? border : elsewhere).add(counts(x - 1, y), counts(x, y));
      if (y > 0) (y % step == 0 ? border : elsewhere).add(counts(x, y - 1), counts(x, y));
    }
  }
  if (border.neighbours == 0.0 || elsewhere.sum == 0.0) return std::nan("");
  return border.sum / border.neighbours / (elsewhere.sum / elsewhere.neighbours);
}

}  // namespace spool
