#include "lib/filters/directional/lone_sizes.h"

#include <algorithm>
#include <array>

#include "lib/core/parallel.h"

namespace spool {
namespace {

constexpr int kReach = 2;  // of the window, pieces
constexpr std::size_t kSide = 2 * kReach + 1;

// The value of `rank` among those of the window, 0 the smallest.
template <class T>
T ranked(const Image<T>& image, int x, int y, std::size_t rank) {
  std::array<T, kSide * kSide> values;
  auto next = values.begin();
  for (int dy = -kReach; dy <= kReach; ++dy) {
    const int row = std::clamp(y + dy, 0, image.height() - 1);
    for (int dx = -kReach; dx <= kReach; ++dx)
      *next++ = image(std::clamp(x + dx, 0, image.width() - 1), row);
  }
  const auto found = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(values, found);
  return *found;
}

bool is_lamp(const Plane& mean, int x, int y) {
  return mean(x, y) > kLampRatio * ranked(mean, x, y, kSide * kSide / 2);
}

}  // namespace

CountImage without_lone_sizes(const CountImage& level, const Plane& kept, const Plane& mean) {
  CountImage opened = level;
  parallel_rows(0, level.height(), [&](int y) {
    for (int x = 0; x < level.width(); ++x) {
      if (!kept.empty() && kept(x, y) > 0.0 && is_lamp(mean, x, y)) continue;
      opened(x, y) = std::max(level(x, y), ranked(level, x, y, kSide - 1));
    }
  });
  return opened;
}

}  // namespace spool
