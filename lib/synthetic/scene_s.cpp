#include "lib/synthetic/scene_s.h"

#include <algorithm>
#include <cmath>

namespace spool {
namespace {

constexpr double kCell = 8.0;    // side of the checker's squares, pixels
constexpr double kBlur = 14.0;   // width of the jitter of the checker, pixels
constexpr double kStreak = 5.0;  // half the width of the streak, pixels down
constexpr double kStreakValue = 1.2, kStreakShare = 0.5;  // of the shutter time
constexpr double kShadowed = 0.25;                        // what a shadowed sample keeps
constexpr double kCheckerLow = 0.15, kCheckerHigh = 0.85;

// Length of [0, v] that lies in odd cells; negative for negative v.
double odd_length(double v) {
  const double period = std::floor(v / (2 * kCell));
  const double rest = v - period * 2 * kCell;
  return period * kCell + std::max(0.0, rest - kCell);
}

// Share of [low, high] in odd cells.
double odd_share(double low, double high) {
  return (odd_length(high) - odd_length(low)) / (high - low);
}

bool odd_cell(double x, double y) {
  const double parity = std::floor(x / kCell) + std::floor(y / kCell);
  return parity - 2.0 * std::floor(parity / 2.0) == 1.0;
}

struct SceneS {
  double w, h;
  SceneSOptions options;

  double line_a() const { return std::cos(0.6) / w; }
  double line_b() const { return std::sin(0.6) / h; }
  static constexpr double kLine = 0.42;
  Circle disc() const { return {0.70 * w, 0.30 * h, 0.14 * std::min(w, h)}; }
  double streak_centre() const { return 0.15 * h + 0.35 * 0.5 * w; }  // of Y + 0.35 X

  // Gradient, slanted edge and disc: what does not vary at a position.
  double surface(double x, double y) const {
    double value = 0.25 + 0.25 * x / w;
    if (line_a() * x + line_b() * y < kLine) value = 0.8 * value + 0.35;
    const Circle circle = disc();
    if (circle.distance(x, y) < circle.radius) value = 0.95;
    return value;
  }
  double visibility(double y) const { return std::clamp((y - 0.45 * h) / (0.35 * h), 0.0, 1.0); }
  bool in_shadow(double x, double y) const { return x > 0.35 * w && y > 0.45 * h; }
  bool in_checker(double x, double y) const { return x < 0.35 * w && y > 0.55 * h; }
  bool in_streak(double x, double y) const {
    return std::abs(y + 0.35 * x - streak_centre()) < kStreak;
  }
  bool in_corner(double x, double y) const { return x > 0.8 * w && y > 0.85 * h; }
  bool in_patch(double x, double y) const {
    return options.fireflies && x > 0.5 * w && x < 0.75 * w && y > 0.75 * h && y < 0.95 * h;
  }

  double value(const SampleDraw& d) const {
    double value = surface(d.x, d.y);
    if (in_shadow(d.x, d.y) && !(d.t < visibility(d.y))) value *= kShadowed;
    if (in_checker(d.x, d.y)) {
      const bool odd = odd_cell(d.x + (d.t - 0.5) * kBlur, d.y + (d.q - 0.5) * kBlur);
      value = odd ? kCheckerHigh : kCheckerLow;
    }
    if (in_streak(d.x, d.y) && d.t < kStreakShare) value = kStreakValue;
    if (in_corner(d.x, d.y)) value = 0.0;
    if (in_patch(d.x, d.y) && d.q < options.firefly_odds) value += options.firefly_value;
    return value;
  }

  // Over t and q at a position. `taken` is the share of t in which the streak hides the rest.
  Moments moments(double x, double y) const {
    if (in_corner(x, y)) return {};
    const double taken = in_streak(x, y) ? kStreakShare : 0.0;
    const double left = 1.0 - taken;
    double low = surface(x, y), high = low, share_high = left;
    if (in_checker(x, y)) {
      const double px = odd_share(x + (taken - 0.5) * kBlur, x + 0.5 * kBlur);
      const double py = odd_share(y - 0.5 * kBlur, y + 0.5 * kBlur);
      low = kCheckerLow;
      high = kCheckerHigh;
      share_high = left * (px * (1.0 - py) + py * (1.0 - px));
    } else if (in_shadow(x, y)) {
      low = kShadowed * high;
      share_high = std::max(0.0, visibility(y) - taken);
    }
    const double share_low = left - share_high;
    Moments m{
        taken * kStreakValue + share_low * low + share_high * high,
        taken * kStreakValue * kStreakValue + share_low * low * low + share_high * high * high};
    // q decides of fireflies alone here: patch and checker do not meet.
    if (in_patch(x, y)) {
      const double p = options.firefly_odds, f = options.firefly_value;
      m.second += p * (2.0 * f * m.first + f * f);
      m.first += p * f;
    }
    return m;
  }

  Creases creases() const {
    Creases all;
    const auto vertical = [&](double x) { all.lines.push_back({1.0, 0.0, x}); };
    const auto horizontal = [&](double y) { all.lines.push_back({0.0, 1.0, y}); };
    for (const double x : {0.35, 0.5, 0.75, 0.8})
      vertical(x * w);
    // 0.625: where half of the visibility is reached, which matters under the streak.
    for (const double y : {0.45, 0.55, 0.625, 0.75, 0.80, 0.85, 0.95})
      horizontal(y * h);
    all.lines.push_back({line_a(), line_b(), kLine});
    for (const double side : {-kStreak, kStreak})
      all.lines.push_back({0.35, 1.0, streak_centre() + side});
    all.circles.push_back(disc());
    // The checker's blur box enters or leaves a cell.
    for (int k = -1; k * kCell <= w + kBlur; ++k) {
      for (const double reach : {-0.5 * kBlur, 0.0, 0.5 * kBlur})
        vertical(k * kCell + reach);
    }
    for (int k = -1; k * kCell <= h + kBlur; ++k) {
      for (const double reach : {-0.5 * kBlur, 0.5 * kBlur})
        horizontal(k * kCell + reach);
    }
    return all;
  }
};

}  // namespace

AnalyticScene scene_s(int width, int height, const SceneSOptions& options) {
  const SceneS scene{static_cast<double>(width), static_cast<double>(height), options};
  AnalyticScene analytic;
  analytic.name = options.fireflies ? "scene_s_fireflies" : "scene_s";
  analytic.width = width;
  analytic.height = height;
  analytic.value = [scene](const SampleDraw& draw) { return scene.value(draw); };
  analytic.moments = [scene, creases = scene.creases()](int x, int y) {
    return pixel_mean(x, y, creases, [&](double px, double py) { return scene.moments(px, py); });
  };
  return analytic;
}

RecordedSamples make_scene_s(int width, int height, int spp, std::uint64_t seed) {
  return make_recording(scene_s(width, height), spp, seed);
}

}  // namespace spool
