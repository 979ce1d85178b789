// Places of events: the slow twin, events anywhere, and a disc of them.
#include "lib/kernels/event_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/core/random.h"
#include "tests/reference/event_places_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

// Four groups of two samples a pixel; each is an event with probability chance(x, y).
template <class Chance>
std::vector<Plane> events(int width, int height, Chance chance) {
  std::vector<Plane> groups(4, Plane(width, height));
  for (std::uint64_t k = 0; k < 4; ++k) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (std::uint64_t s = 0; s < 2; ++s)
          groups[k](x, y) += unit_double(mix(11 + k, x, y, s)) < chance(x, y) ? 0.5 : 0.0;
      }
    }
  }
  return groups;
}

TEST(EventPlaces, EqualsItsSlowTwin) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 3}, {17, 13}, {30, 25}}) {
    auto groups = events(width, height, [](int x, int) { return x < 8 ? 0.2 : 0.02; });
    for (const std::size_t count : {4u, 2u}) {
      groups.resize(count);
      const EventPlaces fast = event_places(groups, 1.5, 4.0, 2.0);
      const reference::EventPlaces slow = reference::event_places(groups, 1.5, 4.0, 2.0);
      for (const auto& [f, s] : {std::pair{&fast.correlation, &slow.correlation},
                                 std::pair{&fast.density, &slow.density}})
        ASSERT_LT(reference::max_difference(*f, *s), 1e-9 * reference::max_abs(*s) + 1e-12)
            << width << "x" << height;
    }
  }
}

TEST(EventPlaces, AreNowhereWithoutEventsAndWhereTheseFallAnywhere) {
  const EventPlaces none = event_places(std::vector<Plane>(4, Plane(20, 9)), 1.5, 8.0, 2.0);
  for (std::size_t i = 0; i < none.density.size(); ++i) {
    EXPECT_EQ(none.correlation[i], 1.0);
    EXPECT_EQ(none.density[i], 0.0);
  }
  const EventPlaces even =
      event_places(events(96, 96, [](int, int) { return 0.03; }), 1.5, 8.0, 2.0);
  const auto [least, most] = std::ranges::minmax(even.correlation.pixels());
  EXPECT_GT(least, 0.7);
  EXPECT_LT(most, 1.35);
}

TEST(EventPlaces, ADiscIsAPlace) {
  const auto distance = [](int x, int y) { return std::hypot(x - 48.0, y - 48.0); };
  const EventPlaces disc =
      event_places(events(96, 96, [&](int x, int y) { return distance(x, y) < 7.0 ? 0.1 : 0.0; }),
                   1.5, 8.0, 2.0);
  EXPECT_GT(disc.correlation(48, 48), 2.0);  // 1 - exp(-7^2 / (2 8^2)) of the window: a third
  EXPECT_LT(disc.correlation(48, 48), 4.0);
  EXPECT_GT(disc.correlation(60, 48), disc.correlation(48, 48));
  EXPECT_NEAR(disc.correlation(2, 2), 1.0, 0.05);  // too far away to tell
  EXPECT_GT(disc.density(48, 48), 1.5);
  EXPECT_LT(disc.density(60, 48), 0.1);
}

}  // namespace
}  // namespace spool
