#include "lib/synthetic/synthetic_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lib/synthetic/scene_s.h"

namespace spool {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Moments of a value that does not vary.
Moments fixed(double value) {
  return {value, value * value};
}

// A value that is `high` with probability p, else `low`.
Moments two_valued(double low, double high, double p) {
  return {low + p * (high - low), low * low + p * (high * high - low * low)};
}

AnalyticScene flat_scene(double level) {
  AnalyticScene scene;
  scene.value = [level](const SampleDraw&) { return level; };
  scene.moments = [level](int, int) { return fixed(level); };
  return scene;
}

// A picture without noise but that of the position, given by its value and creases.
AnalyticScene drawn_scene(std::function<double(double, double)> picture, Creases creases = {}) {
  AnalyticScene scene;
  scene.value = [picture](const SampleDraw& d) { return picture(d.x, d.y); };
  scene.moments = [picture, creases](int x, int y) {
    return pixel_mean(x, y, creases, [&](double px, double py) { return fixed(picture(px, py)); });
  };
  return scene;
}

AnalyticScene constant(int, int, const SyntheticOptions&) {
  return flat_scene(0.5);
}

AnalyticScene black(int, int, const SyntheticOptions&) {
  return flat_scene(0.0);
}

AnalyticScene ramp(int width, int, const SyntheticOptions&) {
  return drawn_scene([width](double x, double) { return x / width; });
}

AnalyticScene slanted_edge(int width, int height, const SyntheticOptions& options) {
  const double angle = options.angle * std::numbers::pi / 180.0;
  const Line edge{-std::sin(angle), std::cos(angle),
                  0.5 * (height * std::cos(angle) - width * std::sin(angle))};
  return drawn_scene(
      [edge](double x, double y) { return edge.a * x + edge.b * y < edge.c ? 0.8 : 0.2; },
      {{edge}, {}});
}

AnalyticScene disc(int width, int height, const SyntheticOptions&) {
  const Circle circle{0.5 * width, 0.5 * height, 0.3 * std::min(width, height)};
  return drawn_scene(
      [circle](double x, double y) { return circle.distance(x, y) < circle.radius ? 0.9 : 0.1; },
      {{}, {circle}});
}

// Rings whose frequency reaches half a cycle per pixel at the ends of the longer side: beyond that
// the mean over a pixel would not be found.
AnalyticScene zone_plate(int width, int height, const SyntheticOptions&) {
  return drawn_scene([width, height](double x, double y) {
    const double dx = x - 0.5 * width, dy = y - 0.5 * height;
    return 0.5 + 0.5 * std::cos(std::numbers::pi * (dx * dx + dy * dy) / std::max(width, height));
  });
}

// Lit with probability x / width: a penumbra as wide as the image.
AnalyticScene soft_shadow(int width, int, const SyntheticOptions&) {
  AnalyticScene scene;
  scene.value = [width](const SampleDraw& d) { return d.t < d.x / width ? 1.0 : 0.0; };
  scene.moments = [width](int x, int) { return two_valued(0.0, 1.0, (x + 0.5) / width); };
  return scene;
}

double sinc(double t) {
  return t == 0.0 ? 1.0 : std::sin(t) / t;
}

// Coin-flip noise whose odds vary across straight streaks and not along them.
AnalyticScene streaks(int, int, const SyntheticOptions& options) {
  const double angle = options.angle * std::numbers::pi / 180.0;
  const double across = 2.0 * std::numbers::pi / (20.0 * options.period);
  const double right = -std::sin(angle) * across, down = std::cos(angle) * across;
  const auto odds = [=](double x, double y) {
    return 0.5 + 0.45 * std::cos(across * (y * std::cos(angle) - x * std::sin(angle)));
  };
  // Of the cosine over a pixel, whose corner may be many periods from its other one.
  const double kept = sinc(0.5 * right) * sinc(0.5 * down);
  AnalyticScene scene;
  scene.value = [odds](const SampleDraw& d) { return d.t < odds(d.x, d.y) ? 1.1 : 0.1; };
  scene.moments = [odds, kept](int x, int y) {
    return two_valued(0.1, 1.1, 0.5 + kept * (odds(x + 0.5, y + 0.5) - 0.5));
  };
  return scene;
}

// Share of [low, low + 1] in odd cells of the given period.
double odd_share(double low, double period) {
  const auto odd_length = [period](double v) {
    const double pairs = std::floor(v / (2 * period));
    return pairs * period + std::max(0.0, v - pairs * 2 * period - period);
  };
  return odd_length(low + 1.0) - odd_length(low);
}

AnalyticScene fine_checker(int, int, const SyntheticOptions& options) {
  const double period = options.period;
  AnalyticScene scene;
  scene.value = [period](const SampleDraw& d) {
    const double cell = std::floor(d.x / period) + std::floor(d.y / period);
    return cell - 2.0 * std::floor(cell / 2.0) == 1.0 ? 0.9 : 0.1;
  };
  scene.moments = [period](int x, int y) {
    const double px = odd_share(x, period), py = odd_share(y, period);
    return two_valued(0.1, 0.9, px * (1.0 - py) + py * (1.0 - px));
  };
  return scene;
}

AnalyticScene fireflies(int, int, const SyntheticOptions& options) {
  AnalyticScene scene;
  scene.value = [options](const SampleDraw& d) {
    return d.q < options.odds ? 0.25 + options.firefly : 0.25;
  };
  scene.moments = [options](int, int) {
    return two_valued(0.25, 0.25 + options.firefly, options.odds);
  };
  return scene;
}

// Pareto: (1 - t)^(-1 / tail), mean tail / (tail - 1).
AnalyticScene heavy_tail(int, int, const SyntheticOptions& options) {
  const double tail = options.tail;
  AnalyticScene scene;
  scene.value = [tail](const SampleDraw& d) { return std::pow(1.0 - d.t, -1.0 / tail); };
  scene.moments = [tail](int, int) -> Moments {
    return {tail / (tail - 1.0), tail > 2.0 ? tail / (tail - 2.0) : kInfinity};
  };
  return scene;
}

// Means near zero from samples of both signs, as filters with negative lobes make them.
AnalyticScene negative_lobes(int width, int, const SyntheticOptions&) {
  const auto low = [width](double x) { return -0.45 + 0.2 * x / width; };
  AnalyticScene scene;
  scene.value = [low](const SampleDraw& d) { return d.t < 0.5 ? low(d.x) : 0.5; };
  scene.moments = [low](int x, int y) {
    return pixel_mean(x, y, {}, [&](double px, double) { return two_valued(low(px), 0.5, 0.5); });
  };
  return scene;
}

// 1e-6 at the left to 1e6 at the right, each sample times a uniform number of [0.5, 1.5).
AnalyticScene high_dynamic_range(int width, int, const SyntheticOptions&) {
  const auto level = [width](double x) { return std::pow(10.0, -6.0 + 12.0 * x / width); };
  AnalyticScene scene;
  scene.value = [level](const SampleDraw& d) { return level(d.x) * (0.5 + d.t); };
  scene.moments = [level](int x, int y) {
    return pixel_mean(x, y, {}, [&](double px, double) -> Moments {
      return {level(px), level(px) * level(px) * 13.0 / 12.0};
    });
  };
  return scene;
}

// Some samples are NaN or infinite; the reference is that of the others.
AnalyticScene not_finite(int, int, const SyntheticOptions& options) {
  AnalyticScene scene;
  scene.value = [options](const SampleDraw& d) {
    if (d.q < 0.5 * options.odds) return std::numeric_limits<double>::quiet_NaN();
    if (d.q < options.odds) return kInfinity;
    return d.t < 0.5 ? 0.25 : 0.75;
  };
  scene.moments = [](int, int) { return two_valued(0.25, 0.75, 0.5); };
  return scene;
}

AnalyticScene scene_s_quiet(int width, int height, const SyntheticOptions&) {
  return scene_s(width, height);
}

AnalyticScene scene_s_loud(int width, int height, const SyntheticOptions& options) {
  return scene_s(width, height, {true, options.odds, options.firefly});
}

}  // namespace

const OptionTable<SyntheticOptions>& synthetic_option_table() {
  using O = SyntheticOptions;
  static const OptionTable<O> table = {
      number_option("angle", &O::angle, -360.0, 360.0,
                    "degrees from +x towards +y, of slanted_edge and streaks"),
      number_option("period", &O::period, 1e-3, 1e3,
                    "pixels, of the squares of fine_checker; streaks are 20 times as far apart"),
      number_option("odds", &O::odds, 0.0, 1.0,
                    "of a firefly, or of a sample of not_finite that is not"),
      number_option("firefly", &O::firefly, 0.0, 1e12, "radiance that a firefly adds"),
      number_option("tail", &O::tail, 1.01, 100.0,
                    "exponent of heavy_tail; the variance is infinite up to 2"),
  };
  return table;
}

const std::vector<SyntheticEntry>& synthetic_scenes() {
  static const std::vector<SyntheticEntry> scenes = {
      {"scene_s", "gradient, edge, disc, soft shadow, blurred checker, streak, black corner",
       scene_s_quiet},
      {"scene_s_fireflies", "the same with a patch of fireflies", scene_s_loud},
      {"constant", "0.5 without noise", constant},
      {"black", "0 everywhere", black},
      {"ramp", "0 at the left to 1 at the right", ramp},
      {"slanted_edge", "a straight edge through the centre", slanted_edge},
      {"disc", "a bright disc on a dark ground", disc},
      {"zone_plate", "rings up to the Nyquist frequency and beyond", zone_plate},
      {"soft_shadow", "lit with a probability that grows from left to right", soft_shadow},
      {"streaks", "coin-flip noise on straight streaks", streaks},
      {"fine_checker", "a checker finer than a pixel", fine_checker},
      {"fireflies", "a grey field with rare bright samples", fireflies},
      {"heavy_tail", "Pareto samples of infinite variance", heavy_tail},
      {"negative_lobes", "samples of both signs with means near zero", negative_lobes},
      {"high_dynamic_range", "means of 1e-6 to 1e6", high_dynamic_range},
      {"not_finite", "some samples are NaN or infinite", not_finite},
  };
  return scenes;
}

Result<AnalyticScene> synthetic_scene(std::string_view name, int width, int height,
                                      const SyntheticOptions& options) {
  if (width < 1 || height < 1) {
    return fail(ErrorCode::kUsage, "a picture of {} x {} pixels: give at least 1 x 1", width,
                height);
  }
  for (const SyntheticEntry& entry : synthetic_scenes()) {
    if (entry.name == name) {
      AnalyticScene scene = entry.make(width, height, options);
      scene.name = entry.name;
      scene.width = width;
      scene.height = height;
      return scene;
    }
  }
  return fail(ErrorCode::kUsage, "{}",
              unknown_name("scene", name, names_of(synthetic_scenes()), ": see spool list scenes"));
}

}  // namespace spool
