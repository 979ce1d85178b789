#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

#include "lib/core/random.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/memory_pool.h"

namespace spool::test {
namespace {

constexpr int kWidth = 24, kHeight = 20, kSpp = 8;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double uniform(int x, int y, int s, int lane) {
  return unit_double(mix(4711, x, y, s, lane));
}

Rgb grey(double value) {
  const auto v = static_cast<float>(value);
  return {v, v, v};
}

// Exponential noise over a gradient with an edge, coloured.
Rgb ordinary(int x, int y, int s) {
  const double mean = (0.2 + 0.03 * x) * (2 * y < kHeight ? 1.0 : 3.0);
  Rgb value{};
  for (int c = 0; c < 3; ++c) {
    value[static_cast<std::size_t>(c)] =
        static_cast<float>(-mean * (1.0 + 0.2 * c) * std::log1p(-uniform(x, y, s, c)));
  }
  return value;
}

template <class Radiance>
std::function<SamplePool()> pool(Radiance radiance, const SanitiseRules& rules = {},
                                 int width = kWidth, int height = kHeight, int spp = kSpp) {
  return [=] { return memory_pool(width, height, spp, radiance, rules); };
}

std::function<SamplePool()> sized(int width, int height, int spp = kSpp) {
  return pool(ordinary, {}, width, height, spp);
}

std::function<SamplePool()> exposed(float factor) {
  return pool([=](int x, int y, int s) {
    Rgb value = ordinary(x, y, s);
    for (float& v : value)
      v *= factor;
    return value;
  });
}

// A share of the samples is `bad`.
std::function<SamplePool()> spoilt(float bad, double share) {
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  return pool(
      [=](int x, int y, int s) {
        Rgb value = ordinary(x, y, s);
        if (uniform(x, y, s, 9) < share) value[static_cast<std::size_t>(s % 3)] = bad;
        return value;
      },
      rules);
}

// Pools of 0 .. kSpp samples, and a corner of 6 x 5 pixels without any.
std::function<SamplePool()> unequal() {
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  return pool(
      [](int x, int y, int s) {
        const bool corner = x < 6 && y < 5;
        const bool beyond = s >= static_cast<int>(mix(5, x, y) % (kSpp + 1));
        return corner || beyond ? grey(kNan) : ordinary(x, y, s);
      },
      rules);
}

std::function<SamplePool()> quarter_pixels() {
  return [] {
    constexpr int kMany = 16;
    std::vector<float> radiance;
    std::vector<FilmPosition> film;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int s = 0; s < kMany; ++s)
            radiance.push_back(ordinary(x, y, s)[c]);
        }
      }
    }
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int s = 0; s < kMany; ++s) {
          // A third of the pixels is lit on one side only: two of their pieces stay empty.
          const double u = uniform(x, y, s, 7) * ((x + y) % 3 == 0 ? 0.5 : 1.0);
          film.push_back({static_cast<float>(u), static_cast<float>(uniform(x, y, s, 8) * 0.999)});
        }
      }
    }
    auto recording = RecordedSamples::from_memory("film", kWidth, kHeight, kMany, radiance);
    recording->set_sample_film(std::move(film));
    add_features(*recording);
    PoolOptions options;
    options.pieces_per_side = 2;
    return pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)), options);
  };
}

// Radiance as ever; `value(layer, component, x, y, s)` for features, none if it is empty.
using Feature = std::function<double(std::string_view, std::size_t, int, int, int)>;

std::function<SamplePool()> featured(const Feature& value) {
  return [=] {
    std::vector<float> radiance;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int s = 0; s < kSpp; ++s)
            radiance.push_back(ordinary(x, y, s)[c]);
        }
      }
    }
    auto recording = RecordedSamples::from_memory("featured", kWidth, kHeight, kSpp, radiance);
    if (value) add_features(*recording, value);
    return pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)));
  };
}

std::function<SamplePool()> held_out() {
  return [] {
    PoolOptions options;
    options.holdout = 6;
    return pool_of(memory_recording(kWidth, kHeight, kSpp, ordinary), options);
  };
}

std::vector<HardCase> make_cases() {
  const bool whole = whole_hard_cases();
  std::vector<HardCase> cases;
  const auto add = [&](std::string name, std::function<SamplePool()> make) -> HardCase& {
    return cases.emplace_back(HardCase{.name = std::move(name), .pool = std::move(make)});
  };
  const auto constant = [&](std::string name, double value) {
    add(std::move(name), pool([=](int, int, int) { return grey(value); })).value = value;
  };
  const auto noise = [&](std::string name, auto&& value_of) {
    add(std::move(name), pool([=](int x, int y, int s) { return grey(value_of(x, y, s)); }));
  };
  const auto firefly = [&](std::string name, float value) {
    SanitiseRules rules;
    rules.allow_many_rejected = true;
    add(std::move(name),
        pool([=](int x, int y,
                 int s) { return x == 12 && y == 11 && s == 1 ? grey(value) : ordinary(x, y, s); },
             rules));
  };

  constant("black", 0.0);
  constant("minus_zero", -0.0);
  constant("constant_quarter", 0.25);
  constant("constant_tenth", static_cast<double>(0.1f));
  constant("constant_negative", -1.0);
  constant("constant_subnormal", static_cast<double>(0x1p-140f));
  constant("constant_largest", static_cast<double>(0x1p49f));
  firefly("firefly_1e6", 1e6f);
  firefly("firefly_1e15", 0.99e15f);
  firefly("firefly_3e38", 3e38f);
  add("nan_5_percent", spoilt(kNan, 0.05));
  add("inf_5_percent", spoilt(kInfinity, 0.05));
  add("minus_inf_half", spoilt(-kInfinity, 0.5));
  noise("negative_mean", [](int x, int y, int s) { return uniform(x, y, s, 0) - 0.7; });
  noise("mixed_sign", [](int x, int y, int s) { return (x + y + s) % 2 == 0 ? 1.0 : -1.0; });
  noise("subnormal", [](int x, int y, int s) { return 1e-41 * (1.0 + uniform(x, y, s, 0)); });
  noise("half_overflow", [](int x, int y, int s) { return 65504.0 * (0.5 + uniform(x, y, s, 0)); });
  add("exposure_1e-30", exposed(0x1p-100f));
  add("exposure_1e-6", exposed(1e-6f));
  add("exposure_1e6", exposed(1e6f));
  add("exposure_1e12", exposed(0x1p40f));
  noise("infinite_variance",
        [](int x, int y, int s) { return std::pow(1.0 - uniform(x, y, s, 0), -1 / 1.5); });
  noise("infinite_mean",
        [](int x, int y, int s) { return std::pow(1.0 - uniform(x, y, s, 0), -1 / 0.8); });
  noise("bernoulli", [](int x, int y, int s) { return uniform(x, y, s, 0) < 0.05 ? 20.0 : 0.0; });
  noise("flat_beside_noisy", [](int x, int y, int s) {
    return (x / 3 + y / 3) % 2 == 0 ? 0.5 : -std::log1p(-uniform(x, y, s, 0));
  });
  noise("large_mean", [](int x, int y, int s) { return 1e6 + 0.2 * uniform(x, y, s, 0); });
  noise("high_dynamic_range", [](int x, int y, int s) {
    return std::pow(10.0, 12.0 * x / (kWidth - 1) - 6.0) * (0.5 + uniform(x, y, s, 0));
  });
  // Luminance 0 everywhere, colour everywhere.
  add("zero_luminance", pool([](int x, int y, int s) {
        const double v = uniform(x, y, s, 0);
        return Rgb{static_cast<float>(v / 0.2126), static_cast<float>(-v / 0.7152), 0.0f};
      }));
  add("unequal_pools", unequal());
  add("one_sample_recorded", sized(kWidth, kHeight, 1));
  add("budget_above_pool", sized(kWidth, kHeight, 3)).spp = {3, 8};
  add("less_than_one_sample", sized(kWidth, kHeight)).spp = {0.01, 0.5};
  add("held_out", held_out());
  add("quarter_pixels", quarter_pixels()).spp = {1, 4, 9};
  add("features_constant", featured([](auto...) { return 0.5; }));
  add("features_zero", featured([](auto...) { return 0.0; }));
  add("features_nan", featured([](std::string_view layer, std::size_t c, int x, int y, int s) {
        return uniform(x, y, s, 6) < 0.3 ? kNan : made_feature(layer, c, x, y, s, kWidth);
      }));
  add("features_infinite", featured([](auto...) { return kInfinity; }));
  add("features_huge", featured([](std::string_view layer, std::size_t c, int x, int y, int s) {
        return 1e14 * made_feature(layer, c, x, y, s, kWidth);
      }));
  HardCase& none = add("features_absent", featured({}));
  none.featureless = true;
  none.spp = {4};
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 3}, {17, 16}, {2, 40}, {40, 2}}) {
    add("size_" + std::to_string(width) + "x" + std::to_string(height), sized(width, height));
  }
  const auto heavy = [&](std::string name, std::function<SamplePool()> make, double spp) {
    HardCase& added = add(std::move(name), std::move(make));
    added.spp = {spp};
    added.heavy = true;
  };
  heavy("size_97x61", sized(97, 61), 4);
  heavy("size_16384x2", sized(whole ? 16384 : 2048, 2, 4), 2);
  heavy("samples_65536", sized(whole ? 4 : 2, 2, 65536), whole ? 65536 : 20000);
  return cases;
}

}  // namespace

bool whole_hard_cases() {
  const char* wanted = std::getenv("SPOOL_HARD_CASES");
  return wanted != nullptr && std::string_view(wanted) == "whole";
}

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> cases = make_cases();
  return cases;
}

}  // namespace spool::test
