// A half-open rectangle of pieces or pixels: [x0, x1) x [y0, y1), x right, y down.
#pragma once

#include <algorithm>

namespace spool {

struct Rectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  long long area() const { return empty() ? 0 : static_cast<long long>(width()) * height(); }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  friend bool operator==(const Rectangle&, const Rectangle&) = default;
};

inline Rectangle intersect(const Rectangle& a, const Rectangle& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

// The smallest rectangle that holds both; an empty one does not count.
inline Rectangle unite(const Rectangle& a, const Rectangle& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// Grows by the given reach on each side, then clips to `bounds`.
inline Rectangle grow(const Rectangle& r, int left, int right, int up, int down,
                      const Rectangle& bounds) {
  return intersect({r.x0 - left, r.y0 - up, r.x1 + right, r.y1 + down}, bounds);
}

}  // namespace spool
