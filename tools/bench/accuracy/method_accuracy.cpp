// The parts of the method: pyramid, filter bank, size selection, anisotropic filter.
#include <numbers>

#include <fmt/core.h>

#include "lib/directions/directional_filter_bank.h"
#include "lib/filters/directional/anisotropic_filter.h"
#include "lib/filters/directional/filter_size.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "tests/reference/convolution_reference.h"
#include "tests/reference/directional_filter_bank_reference.h"
#include "tools/bench/accuracy/accuracy.h"

namespace spool::bench {

void measure_pyramid(std::vector<Row>& rows) {
  const std::pair<const char*, WaveletFilter> filters[] = {{"haar", WaveletFilter::kHaar},
                                                           {"5-3", WaveletFilter::k53},
                                                           {"9-7", WaveletFilter::k97},
                                                           {"db3", WaveletFilter::kDb3}};
  for (const NamedImage& test : test_images(97, 61)) {
    for (const auto& [name, filter] : filters) {
      PyramidOptions options;
      options.filter = filter;
      const Pyramid pyramid = build_pyramid(test.image, options);
      double coarse_error = 0.0, detail_error = 0.0;
      Image<Fine> fine = widened(test.image);
      Fine size = 0;
      for (const Fine v : fine.pixels())
        size = std::max(size, std::abs(v));
      for (int k = 0; k < options.levels; ++k) {
        const auto level = static_cast<std::size_t>(k);
        const FilterPair pair = filter_pair_at(options.filter, options.roles, k);
        const int dilation = pyramid_dilation(k);
        const Image<Fine> coarse =
            reference::convolve(fine, pair.analysis, dilation, options.extension);
        Image<Fine> detail =
            reference::convolve(coarse, scaled(pair.synthesis, 0.5), dilation, options.extension);
        for (std::size_t i = 0; i < detail.size(); ++i)
          detail[i] = fine[i] - detail[i];
        coarse_error = std::max(coarse_error, largest_error(pyramid.coarse[level + 1], coarse));
        // Details may be tiny beside the image: their error is one of the image.
        for (std::size_t i = 0; i < detail.size(); ++i)
          detail_error = std::max(
              detail_error,
              static_cast<double>(std::abs(pyramid.detail[level][i] - detail[i]) / (size * kUnit)));
        fine = coarse;
      }
      rows.push_back({"pyramid", fmt::format("f_1 .. f_4, {}", name), test.name, coarse_error,
                      "ulp of max f_k"});
      rows.push_back({"pyramid", fmt::format("d_0 .. d_3, {}", name), test.name, detail_error,
                      "ulp of max f_0"});
      rows.push_back({"pyramid", fmt::format("collapse of build, {}", name), test.name,
                      largest_error(collapse(pyramid, options), widened(test.image)),
                      "ulp of max f_0"});
    }
  }
}

void measure_bank(std::vector<Row>& rows) {
  for (const NamedImage& test : test_images(33, 29)) {
    for (const int levels : {2, 3}) {
      BankOptions options;
      options.levels = levels;
      const auto exact = reference::directional_bands(widened(test.image), options);
      Fine size = 0;
      for (const double v : test.image.pixels())
        size = std::max(size, static_cast<Fine>(std::abs(v)));
      const auto error_of = [&](const auto& bands) {
        Fine largest = 0;
        for (std::size_t b = 0; b < exact.size(); ++b) {
          for (std::size_t i = 0; i < exact[b].size(); ++i)
            largest = std::max(largest, std::abs(static_cast<Fine>(bands[b][i]) - exact[b][i]));
        }
        return static_cast<double>(largest / size);
      };
      Image<float> narrow(test.image.width(), test.image.height());
      for (std::size_t i = 0; i < narrow.size(); ++i)
        narrow[i] = static_cast<float>(test.image[i]);
      rows.push_back({"filter bank", fmt::format("{} bands, double", 1 << levels), test.name,
                      error_of(directional_bands(test.image, options)) / kUnit,
                      "ulp of the image"});
      rows.push_back(
          {"filter bank", fmt::format("{} bands, float", 1 << levels), test.name,
           error_of(directional_bands(narrow, options)) / std::numeric_limits<float>::epsilon(),
           "ulp (float) of the image"});
    }
  }
}

// T_k of eq 9 with the robust rule, and how many decisions rounding changes.
void measure_sizes(std::vector<Row>& rows) {
  for (const NamedImage& test : test_images(97, 61)) {
    const int width = test.image.width(), height = test.image.height();
    Plane variance(width, height);
    CountImage n(width, height, 8);
    for (std::size_t p = 0; p < variance.size(); ++p)
      variance[p] = (test.image[0] > 1e3 ? 1e-5 : 0.01) * (0.5 + uniform(31, p));
    FilterSizeOptions options;
    options.smooth = SizeSmooth::kOff;  // eq 9 alone, without what neighbours say
    options.evidence = 0.0;
    Views views({"T"});
    GuardCounts guards;
    const CountImage level = filter_size(
        {test.image, variance, n, test.image, test.image, {}, {}, 4}, options, &views, guards);
    double error = 0.0;
    CountImage exact_level(width, height, 4);
    for (int k = 3; k >= 0; --k) {
      const Plane& t = views.collected()[static_cast<std::size_t>(k)].image;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const auto region = [&](int size, Fine& s, Fine& q) {
            const int before = size == 0 ? 0 : 1 << (size - 1);
            Fine count = 0, v = 0, mean = 0;
            for (int py = y - before; py < y - before + (1 << size); ++py) {
              for (int px = x - before; px < x - before + (1 << size); ++px) {
                if (px < 0 || py < 0 || px >= width || py >= height) continue;
                count += 1, v += variance(px, py), mean += test.image(px, py);
              }
            }
            s = v / (count * count), q = mean / count;
          };
          Fine s0, q0, s1, q1;
          region(k, s0, q0);
          region(k + 1, s1, q1);
          const Fine dq = q1 - q0, w = options.factor.constant;
          const Fine exact = s1 - s0 + w * dq * dq;
          if (exact > 0) exact_level(x, y) = k;
          // Of the terms that make it up.
          const Fine size = s0 + s1 + w * (std::abs(q0) + std::abs(q1)) * std::abs(dq);
          error = std::max(error, static_cast<double>(std::abs(t(x, y) - exact) / size / kUnit));
        }
      }
    }
    long long changed = 0;
    for (std::size_t p = 0; p < level.size(); ++p)
      changed += level[p] != exact_level[p] ? 1 : 0;
    rows.push_back({"size selection", "T_0 .. T_3", test.name, error, "ulp of its terms"});
    rows.push_back({"size selection", fmt::format("sizes of {} pieces", level.size()), test.name,
                    static_cast<double>(changed), "differ"});
  }
}

// Eqs 10-12 with random widths along eight directions.
template <class T>
double filter_error(const Plane& image, int k) {
  const int width = image.width(), height = image.height();
  FilterWidths<T> widths;
  widths.dominant = Plane(width, height);
  for (int i = 0; i < 8; ++i) {
    widths.beta.push_back(22.5 * i);
    Image<T> delta(width, height);
    for (std::size_t p = 0; p < delta.size(); ++p)
      delta[p] = static_cast<T>(0.25 + 4.0 * uniform(41 + static_cast<std::uint64_t>(i), p));
    widths.delta.push_back(delta);
  }
  const CountImage n(width, height, 4), level(width, height, k);
  const RgbImage mean = {image, image, image};
  GuardCounts guards;
  const FilterOptions options;
  const FilteredPieces found = filter_pieces<T>({n, level, mean, mean}, widths, options, guards);
  Image<Fine> exact(width, height);
  const int radius = 1 << (k - 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Fine total = 0, value = 0;
      for (int py = std::max(0, y - radius); py <= std::min(height - 1, y + radius); ++py) {
        for (int px = std::max(0, x - radius); px <= std::min(width - 1, x + radius); ++px) {
          const int dx = px - x, dy = py - y;
          if (options.window == FilterWindow::kDisc && dx * dx + dy * dy > radius * radius)
            continue;
          Fine omega = 1;
          if (dx != 0 || dy != 0) {
            Fine b = std::atan2(static_cast<Fine>(dy), static_cast<Fine>(dx)) * 180 /
                     std::numbers::pi_v<Fine>;
            b = b < 0 ? b + 180 : b;
            b = b >= 180 ? b - 180 : b;
            const auto lower = std::min<std::size_t>(7, static_cast<std::size_t>(b / 22.5L));
            const Fine t = b / 22.5L - static_cast<Fine>(lower);
            const Fine delta = (1 - t) * static_cast<Fine>(widths.delta[lower](x, y)) +
                               t * static_cast<Fine>(widths.delta[(lower + 1) % 8](x, y));
            omega = std::exp(-static_cast<Fine>(dx * dx + dy * dy) / (2 * delta * delta));
          }
          total += omega;
          value += omega * image(px, py);
        }
      }
      exact(x, y) = value / total;
    }
  }
  return largest_error(found.image[0], exact) * kUnit;
}

void measure_filter(std::vector<Row>& rows) {
  for (const NamedImage& test : test_images(61, 43)) {
    for (const int k : {2, 4}) {
      rows.push_back({"anisotropic filter", fmt::format("size {}, weights in double", 1 << k),
                      test.name, filter_error<double>(test.image, k) / kUnit, "ulp of the image"});
      rows.push_back({"anisotropic filter", fmt::format("size {}, weights in float", 1 << k),
                      test.name, filter_error<float>(test.image, k), "relative"});
    }
  }
}

}  // namespace spool::bench
