#include "lib/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "lib/core/colour.h"
#include "lib/core/parallel.h"
#include "lib/metrics/weighted_rows.h"

namespace spool {
namespace {

using Triple = std::array<double, 3>;

// Linear sRGB to XYZ, rows X, Y, Z, and the white it gives (1, 1, 1).
constexpr ColourMatrix kToXyz = {{{0.4123865633, 0.3575914909, 0.1804504912},
                                  {0.2126368217, 0.7151829818, 0.0721801965},
                                  {0.0193306202, 0.1191971636, 0.9503725870}}};
constexpr Triple kWhite = {0.950428545, 1.0, 1.088900371};

constexpr double kColourExponent = 0.7;  // q_c of [AnderssonEtAl20]
constexpr double kPc = 0.4, kPt = 0.95;  // p_c, p_t
constexpr double kFeatureWidth = 0.082;  // degrees, w

Triple times(const ColourMatrix& m, const Triple& v) {
  Triple result{};
  for (std::size_t r = 0; r < 3; ++r)
    result[r] = m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
  return result;
}

// Opponent space of the contrast sensitivity functions, linear in XYZ.
Triple to_ycxcz(const Triple& rgb) {
  Triple xyz = times(kToXyz, rgb);
  for (std::size_t c = 0; c < 3; ++c)
    xyz[c] /= kWhite[c];
  return {116.0 * xyz[1] - 16.0, 500.0 * (xyz[0] - xyz[1]), 200.0 * (xyz[1] - xyz[2])};
}

Triple from_ycxcz(const Triple& ycxcz) {
  static const ColourMatrix to_rgb = inverse(kToXyz);
  const double y = (ycxcz[0] + 16.0) / 116.0;
  return times(to_rgb, {(y + ycxcz[1] / 500.0) * kWhite[0], y * kWhite[1],
                        (y - ycxcz[2] / 200.0) * kWhite[2]});
}

// CIELab with the Hunt effect: colours fade with darkness.
Triple to_hunt_lab(const Triple& rgb) {
  constexpr double kDelta = 6.0 / 29.0;
  Triple f = times(kToXyz, rgb);
  for (std::size_t c = 0; c < 3; ++c) {
    const double t = f[c] / kWhite[c];
    f[c] = t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  }
  const double l = 116.0 * f[1] - 16.0;
  return {l, 0.01 * l * 500.0 * (f[0] - f[1]), 0.01 * l * 200.0 * (f[1] - f[2])};
}

// Of numbers below 1000: std::hypot guards against more and takes ten times as long.
double length(double x, double y) {
  return std::sqrt(x * x + y * y);
}

double hyab(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + length(a[1] - b[1], a[2] - b[2]);
}

// Colour difference to [0, 1]: the largest differences share the last 5 %.
double redistributed(double distance) {
  static const double largest =
      std::pow(hyab(to_hunt_lab({0.0, 1.0, 0.0}), to_hunt_lab({0.0, 0.0, 1.0})), kColourExponent);
  const double d = std::pow(distance, kColourExponent);
  const double knee = kPc * largest;
  return d < knee ? d * kPt / knee : kPt + (d - knee) / (largest - knee) * (1.0 - kPt);
}

using Taps = std::vector<double>;  // 2 r + 1 of them, centred

template <class Weight>
Taps make_taps(int radius, Weight&& weight) {
  Taps taps;
  for (int i = -radius; i <= radius; ++i)
    taps.push_back(weight(static_cast<double>(i)));
  return taps;
}

double sum_of(const Taps& taps) {
  double sum = 0.0;
  for (const double tap : taps)
    sum += tap;
  return sum;
}

// Positive taps scaled to sum 1, negative ones to sum -1.
Taps balanced(Taps taps) {
  double positive = 0.0, negative = 0.0;
  for (const double tap : taps)
    (tap > 0.0 ? positive : negative) += std::abs(tap);
  for (double& tap : taps)
    tap /= tap > 0.0 ? positive : (negative > 0.0 ? negative : 1.0);
  return taps;
}

Plane convolved_across(const Plane& image, const Taps& taps) {
  const int width = image.width(), r = static_cast<int>(taps.size()) / 2;
  Plane result(width, image.height());
  parallel_rows(0, image.height(), [&](int y) {
    std::vector<double> wide(static_cast<std::size_t>(width + 2 * r));
    for (int x = -r; x < width + r; ++x)
      wide[static_cast<std::size_t>(x + r)] = image(std::clamp(x, 0, width - 1), y);
    std::vector<const double*> from;
    for (std::size_t i = 0; i < taps.size(); ++i)
      from.push_back(&wide[i]);
    add_rows(taps, from, &result(0, y), width);
  });
  return result;
}

Plane convolved_down(const Plane& image, const Taps& taps) {
  const int height = image.height(), r = static_cast<int>(taps.size()) / 2;
  Plane result(image.width(), height);
  parallel_rows(0, height, [&](int y) {
    std::vector<const double*> from;
    for (int i = -r; i <= r; ++i)
      from.push_back(&image(0, std::clamp(y + i, 0, height - 1)));
    add_rows(taps, from, &result(0, y), image.width());
  });
  return result;
}

// One Gaussian of a contrast sensitivity function: amplitude and width.
struct Sensitivity {
  double a, b;
};

// Filters a channel with the normalised sum of Gaussians.
Plane sensed(const Plane& channel, const std::vector<Sensitivity>& gaussians) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kWidest = 0.04;
  const int radius = static_cast<int>(
      std::ceil(3.0 * std::sqrt(kWidest / (2.0 * kPi * kPi)) * kFlipPixelsPerDegree));
  std::vector<Taps> taps;
  std::vector<double> amplitude;
  double total = 0.0;
  for (const Sensitivity& g : gaussians) {
    taps.push_back(make_taps(radius, [&](double i) {
      const double degrees = i / kFlipPixelsPerDegree;
      return std::exp(-kPi * kPi * degrees * degrees / g.b);
    }));
    amplitude.push_back(g.a * std::sqrt(kPi / g.b));
    total += amplitude.back() * sum_of(taps.back()) * sum_of(taps.back());
  }
  Plane result(channel.width(), channel.height());
  for (std::size_t g = 0; g < taps.size(); ++g) {
    const Plane part = convolved_down(convolved_across(channel, taps[g]), taps[g]);
    for (std::size_t p = 0; p < result.size(); ++p)
      result[p] += amplitude[g] / total * part[p];
  }
  return result;
}

Triple shown(const RgbImage& image, std::size_t p) {
  return {std::clamp(image[0][p], 0.0, 1.0), std::clamp(image[1][p], 0.0, 1.0),
          std::clamp(image[2][p], 0.0, 1.0)};
}

// Through the eye's filter, with the Hunt effect.
RgbImage seen_colours(RgbImage opponent) {
  opponent = {sensed(opponent[0], {{1.0, 0.0047}}), sensed(opponent[1], {{1.0, 0.0053}}),
              sensed(opponent[2], {{34.1, 0.04}, {13.5, 0.025}})};
  RgbImage lab = std::move(opponent);
  parallel_rows(0, lab[0].height(), [&](int y) {
    for (int x = 0; x < lab[0].width(); ++x) {
      const std::size_t p = lab[0].index(x, y);
      Triple rgb = from_ycxcz({lab[0][p], lab[1][p], lab[2][p]});
      for (double& v : rgb)
        v = std::clamp(v, 0.0, 1.0);
      const Triple hunt = to_hunt_lab(rgb);
      for (std::size_t c = 0; c < 3; ++c)
        lab[c][p] = hunt[c];
    }
  });
  return lab;
}

void add_features(const Plane& achromatic, FlipView& view) {
  const double sigma = 0.5 * kFeatureWidth * kFlipPixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto bell = [&](double x) { return std::exp(-x * x / (2.0 * sigma * sigma)); };
  Taps smooth = make_taps(radius, bell);
  const double sum = sum_of(smooth);
  for (double& tap : smooth)
    tap /= sum;
  const Taps first = balanced(make_taps(radius, [&](double x) { return -x * bell(x); }));
  const Taps second = balanced(
      make_taps(radius, [&](double x) { return (x * x / (sigma * sigma) - 1.0) * bell(x); }));
  const Plane smooth_rows = convolved_across(achromatic, smooth);
  const auto magnitude = [&](const Taps& taps) {
    Plane across = convolved_down(convolved_across(achromatic, taps), smooth);
    const Plane down = convolved_down(smooth_rows, taps);
    for (std::size_t p = 0; p < across.size(); ++p)
      across[p] = length(across[p], down[p]);
    return across;
  };
  view.edge = magnitude(first);
  view.point = magnitude(second);
}

// Tone curve of HDR-FLIP: the ACES fit with its exposure of 0.6 folded in.
double aces(double x) {
  return std::clamp((0.9036 * x * x + 0.018 * x) / (0.8748 * x * x + 0.354 * x + 0.14), 0.0, 1.0);
}

// The x > 0 with aces(x) = 0.85: (0.9036 - 0.85 * 0.8748) x^2 + ... = 0.
double aces_at_85_percent() {
  const double a = 0.9036 - 0.85 * 0.8748, b = 0.018 - 0.85 * 0.354, c = -0.85 * 0.14;
  return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

RgbImage exposed(const RgbImage& image, double exponent) {
  const double factor = std::exp2(exponent);
  RgbImage result = image;
  for (Plane& plane : result) {
    for (double& v : plane.pixels())
      v = aces(std::max(v, 0.0) * factor);
  }
  return result;
}

bool alike(const RgbImage& a, const RgbImage& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (!std::ranges::equal(a[c].pixels(), b[c].pixels())) return false;
  return true;
}

}  // namespace

FlipView flip_view(const RgbImage& image) {
  const int width = image[0].width(), height = image[0].height();
  RgbImage opponent = make_rgb(width, height);
  Plane achromatic(width, height);
  for (std::size_t p = 0; p < achromatic.size(); ++p) {
    const Triple ycxcz = to_ycxcz(shown(image, p));
    for (std::size_t c = 0; c < 3; ++c)
      opponent[c][p] = ycxcz[c];
    achromatic[p] = (ycxcz[0] + 16.0) / 116.0;
  }
  FlipView view{seen_colours(std::move(opponent)), {}, {}};
  add_features(achromatic, view);
  return view;
}

Plane flip_difference(const FlipView& r, const FlipView& t) {
  Plane map(r.edge.width(), r.edge.height());
  parallel_rows(0, map.height(), [&](int y) {
    for (int x = 0; x < map.width(); ++x) {
      const std::size_t p = map.index(x, y);
      const double colour = redistributed(
          hyab({r.lab[0][p], r.lab[1][p], r.lab[2][p]}, {t.lab[0][p], t.lab[1][p], t.lab[2][p]}));
      // Its exponent q_f is 1/2.
      const double feature =
          std::sqrt(std::max(std::abs(r.edge[p] - t.edge[p]), std::abs(r.point[p] - t.point[p])) /
                    std::numbers::sqrt2);
      // 0^0 is 0 here: no colour difference is no difference.
      map[p] = colour > 0.0 ? std::pow(colour, 1.0 - feature) : 0.0;
    }
  });
  return map;
}

Plane flip_ldr_map(const RgbImage& reference, const RgbImage& test) {
  SPOOL_CHECK(reference[0].same_size(test[0]));
  return flip_difference(flip_view(reference), flip_view(test));
}

std::optional<FlipExposures> flip_exposures(const RgbImage& reference,
                                            const Image<std::uint8_t>& judged) {
  std::vector<double> luminances;
  for (std::size_t p = 0; p < reference[0].size(); ++p) {
    if (!judged.empty() && judged[p] == 0) continue;
    luminances.push_back(kToXyz[1][0] * reference[0][p] + kToXyz[1][1] * reference[1][p] +
                         kToXyz[1][2] * reference[2][p]);
  }
  if (luminances.empty()) return std::nullopt;
  std::sort(luminances.begin(), luminances.end());
  const double brightest = luminances.back();
  if (!(brightest > 0.0)) return std::nullopt;
  // The upper median, as the authors' program takes it; where half the image is black, the darkest
  // pixel that is not.
  double median = luminances[luminances.size() / 2];
  if (!(median > 0.0)) median = *std::upper_bound(luminances.begin(), luminances.end(), 0.0);
  FlipExposures exposures;
  exposures.start = std::log2(aces_at_85_percent() / brightest);
  exposures.stop = std::log2(aces_at_85_percent() / median);
  // One for each stop, as the authors have it; theirs are without a bound, and a range of 2^150 is
  // a finite picture.
  const double stops = std::ceil(exposures.stop - exposures.start);
  exposures.count = static_cast<int>(std::clamp(stops, 2.0, double{kMostFlipExposures}));
  return exposures;
}

std::optional<Plane> flip_hdr_map(const RgbImage& reference, const RgbImage& test,
                                  const Image<std::uint8_t>& judged) {
  const std::optional<FlipExposures> exposures = flip_exposures(reference, judged);
  if (!exposures) return std::nullopt;
  Plane worst(reference[0].width(), reference[0].height());
  for (int i = 0; i < exposures->count; ++i) {
    const double e =
        exposures->start + (exposures->stop - exposures->start) * i / (exposures->count - 1);
    const RgbImage shown = exposed(reference, e), other = exposed(test, e);
    if (alike(shown, other)) continue;  // also where both are black, or white
    const Plane map = flip_ldr_map(shown, other);
    for (std::size_t p = 0; p < worst.size(); ++p)
      worst[p] = std::max(worst[p], map[p]);
  }
  return worst;
}

}  // namespace spool
