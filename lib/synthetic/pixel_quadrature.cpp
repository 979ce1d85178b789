#include "lib/synthetic/pixel_quadrature.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace spool {
namespace {

constexpr int kOrder = 16;

struct GaussRule {
  std::array<double, kOrder> node, weight;  // on [0, 1]
};

// Roots of the Legendre polynomial by Newton's method; weights 2 / ((1 - x^2) P'(x)^2).
GaussRule make_rule() {
  GaussRule rule{};
  for (int i = 0; i < kOrder; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (kOrder + 0.5));
    double slope = 0.0;
    for (int step = 0; step < 50; ++step) {
      double p = 1.0, before = 0.0;
      for (int n = 1; n <= kOrder; ++n) {
        const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p;
        p = next;
      }
      slope = kOrder * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.node[static_cast<std::size_t>(i)] = 0.5 * (1.0 - x);
    rule.weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

const GaussRule& rule() {
  static const GaussRule gauss = make_rule();
  return gauss;
}

class Cuts {
 public:
  Cuts(double low, double high) : low_(low), high_(high) { at_ = {low, high}; }
  void add(double value) {
    if (value > low_ && value < high_) at_.push_back(value);
  }
  const std::vector<double>& sorted() {
    std::sort(at_.begin(), at_.end());
    return at_;
  }

 private:
  double low_, high_;
  std::vector<double> at_;
};

bool touches(const Line& line, double x, double y) {
  if (line.a == 1.0 && line.b == 0.0) return line.c >= x && line.c <= x + 1.0;
  if (line.a == 0.0 && line.b == 1.0) return line.c >= y && line.c <= y + 1.0;
  double low = 1e300, high = -1e300;
  for (const double dx : {0.0, 1.0}) {
    for (const double dy : {0.0, 1.0}) {
      const double side = line.a * (x + dx) + line.b * (y + dy) - line.c;
      low = std::min(low, side);
      high = std::max(high, side);
    }
  }
  return low <= 0.0 && high >= 0.0;
}

bool touches(const Circle& circle, double x, double y) {
  return std::abs(circle.distance(x + 0.5, y + 0.5) - circle.radius) < 0.75;
}

// The creases that touch the pixel.
Creases near_pixel(const Creases& creases, int x, int y) {
  Creases near;
  for (const Line& line : creases.lines) {
    if (touches(line, x, y)) near.lines.push_back(line);
  }
  for (const Circle& circle : creases.circles) {
    if (touches(circle, x, y)) near.circles.push_back(circle);
  }
  return near;
}

// Y where the circle meets the line, both solutions.
void add_crossings(const Line& line, const Circle& circle, Cuts& cuts) {
  const double length2 = line.a * line.a + line.b * line.b;
  const double offset = (line.a * circle.x + line.b * circle.y - line.c) / length2;
  const double square = circle.radius * circle.radius / length2 - offset * offset;
  if (square < 0.0) return;
  const double reach = std::sqrt(square);
  cuts.add(circle.y - line.b * offset + line.a * reach);
  cuts.add(circle.y - line.b * offset - line.a * reach);
}

// Y at which the structure of a row changes.
Cuts row_cuts(int x, int y, const Creases& near) {
  Cuts cuts(y, y + 1.0);
  std::vector<Line> lines = near.lines;
  lines.push_back({1.0, 0.0, static_cast<double>(x)});
  lines.push_back({1.0, 0.0, x + 1.0});
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].a == 0.0) cuts.add(lines[i].c / lines[i].b);
    for (std::size_t j = 0; j < i; ++j) {
      const double det = lines[i].a * lines[j].b - lines[j].a * lines[i].b;
      if (det != 0.0) cuts.add((lines[i].a * lines[j].c - lines[j].a * lines[i].c) / det);
    }
    for (const Circle& circle : near.circles)
      add_crossings(lines[i], circle, cuts);
  }
  for (const Circle& circle : near.circles) {
    cuts.add(circle.y - circle.radius);
    cuts.add(circle.y + circle.radius);
  }
  return cuts;
}

Moments row_mean(int x, double y, const Creases& near,
                 const std::function<Moments(double, double)>& moments) {
  Cuts cuts(x, x + 1.0);
  for (const Line& line : near.lines) {
    if (line.a != 0.0) cuts.add((line.c - line.b * y) / line.a);
  }
  for (const Circle& circle : near.circles) {
    const double dy = y - circle.y;
    const double square = circle.radius * circle.radius - dy * dy;
    if (square < 0.0) continue;
    const double reach = std::sqrt(square);
    cuts.add(circle.x - reach);
    cuts.add(circle.x + reach);
  }
  const std::vector<double>& at = cuts.sorted();
  Moments sum;
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    const double width = at[k + 1] - at[k];
    for (std::size_t i = 0; i < kOrder; ++i) {
      const Moments m = moments(at[k] + width * rule().node[i], y);
      sum.first += width * rule().weight[i] * m.first;
      sum.second += width * rule().weight[i] * m.second;
    }
  }
  return sum;
}

}  // namespace

Moments pixel_mean(int x, int y, const Creases& creases,
                   const std::function<Moments(double, double)>& moments) {
  const Creases near = near_pixel(creases, x, y);
  Cuts cuts = row_cuts(x, y, near);
  const std::vector<double>& at = cuts.sorted();
  Moments sum;
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    const double height = at[k + 1] - at[k];
    for (std::size_t j = 0; j < kOrder; ++j) {
      const double s = rule().node[j];
      const double weight = height * 6.0 * s * (1.0 - s) * rule().weight[j];
      const Moments m = row_mean(x, at[k] + height * s * s * (3.0 - 2.0 * s), near, moments);
      sum.first += weight * m.first;
      sum.second += weight * m.second;
    }
  }
  return sum;
}

}  // namespace spool
