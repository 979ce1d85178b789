#include "lib/filters/wavelet_transform.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/parallel.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {
namespace {

// Analysis low and high about even and odd samples, synthesis likewise; offsets symmetric about 0.
struct Bank {
  Taps low, high, rebuild_low, rebuild_high;
};

Taps modulated(Taps taps) {
  for (std::size_t i = 0; i < taps.values.size(); ++i) {
    if ((taps.first + static_cast<int>(i)) % 2 != 0) taps.values[i] = -taps.values[i];
  }
  return taps;
}

Bank cdf97_bank() {
  const FilterPair pair = filter_pair(WaveletFilter::k97);
  const Taps low = scaled(pair.analysis, std::numbers::sqrt2);
  const Taps rebuild = scaled(pair.synthesis, 1.0 / std::numbers::sqrt2);
  return {low, modulated(rebuild), rebuild, modulated(low)};
}

double tap_at(const Taps& taps, int m) {
  if (m < taps.first || m > taps.last()) return 0.0;
  return taps.values[static_cast<std::size_t>(m - taps.first)];
}

double filtered(const Taps& taps, const std::vector<double>& line, int centre, TransformOf of) {
  const int n = static_cast<int>(line.size());
  double sum = 0.0;
  for (int m = taps.first; m <= taps.last(); ++m) {
    const double tap = tap_at(taps, m);
    sum += (of == TransformOf::kValues ? tap : tap * tap) *
           line[static_cast<std::size_t>(extend(centre - m, n, Extension::kWhole))];
  }
  return sum;
}

void split_line(std::vector<double>& line, std::vector<double>& out, const Bank& bank,
                TransformOf of) {
  const int half = static_cast<int>(line.size()) / 2;
  for (int i = 0; i < half; ++i) {
    const auto low = static_cast<std::size_t>(i), high = static_cast<std::size_t>(half + i);
    out[low] = filtered(bank.low, line, 2 * i, of);
    out[high] = filtered(bank.high, line, 2 * i + 1, of);
  }
  line.swap(out);
}

void join_line(std::vector<double>& line, std::vector<double>& out, const Bank& bank) {
  const int n = static_cast<int>(line.size()), half = n / 2;
  for (int x = 0; x < n; ++x) {
    double sum = 0.0;
    // Position p of the zero-stuffed bands: low on even p, high on odd p.
    for (int m = bank.rebuild_high.first; m <= bank.rebuild_high.last(); ++m) {
      const int p = extend(x - m, n, Extension::kWhole);
      const double coefficient = line[static_cast<std::size_t>(p % 2 == 0 ? p / 2 : half + p / 2)];
      sum += tap_at(p % 2 == 0 ? bank.rebuild_low : bank.rebuild_high, m) * coefficient;
    }
    out[static_cast<std::size_t>(x)] = sum;
  }
  line.swap(out);
}

// What split_line gathers this scatters.
void split_line_transposed(std::vector<double>& line, std::vector<double>& out, const Bank& bank) {
  const int n = static_cast<int>(line.size()), half = n / 2;
  std::ranges::fill(out, 0.0);
  const auto scatter = [&](const Taps& taps, int centre, double value) {
    for (int m = taps.first; m <= taps.last(); ++m)
      out[static_cast<std::size_t>(extend(centre - m, n, Extension::kWhole))] +=
          tap_at(taps, m) * value;
  };
  for (int i = 0; i < half; ++i) {
    scatter(bank.low, 2 * i, line[static_cast<std::size_t>(i)]);
    scatter(bank.high, 2 * i + 1, line[static_cast<std::size_t>(half + i)]);
  }
  line.swap(out);
}

void join_line_transposed(std::vector<double>& line, std::vector<double>& out, const Bank& bank) {
  const int n = static_cast<int>(line.size()), half = n / 2;
  std::ranges::fill(out, 0.0);
  for (int x = 0; x < n; ++x) {
    for (int m = bank.rebuild_high.first; m <= bank.rebuild_high.last(); ++m) {
      const int p = extend(x - m, n, Extension::kWhole);
      out[static_cast<std::size_t>(p % 2 == 0 ? p / 2 : half + p / 2)] +=
          tap_at(p % 2 == 0 ? bank.rebuild_low : bank.rebuild_high, m) *
          line[static_cast<std::size_t>(x)];
    }
  }
  line.swap(out);
}

// line_step on every row of the w x h corner, or on every column.
enum class Lines { kRows, kColumns };

template <class Step>
void over_lines(Plane& image, int w, int h, Lines lines, Step&& line_step) {
  const bool rows = lines == Lines::kRows;
  const int length = rows ? w : h;
  parallel_rows(0, rows ? h : w, [&](int at) {
    const auto pixel = [&](int i) -> double& { return rows ? image(i, at) : image(at, i); };
    std::vector<double> line(static_cast<std::size_t>(length)), out(line.size());
    for (int i = 0; i < length; ++i)
      line[static_cast<std::size_t>(i)] = pixel(i);
    line_step(line, out);
    for (int i = 0; i < length; ++i)
      pixel(i) = line[static_cast<std::size_t>(i)];
  });
}

// line_step(line, out, bank) on rows, then on columns, of each level from the finest on; or the
// other way round, last first.
enum class Order { kFinestFirst, kFinestLast };

template <class Step>
void over_levels(Plane& image, int levels, Order order, Step&& line_step) {
  SPOOL_CHECK_EQ(image.width() % (1 << levels), 0);
  SPOOL_CHECK_EQ(image.height() % (1 << levels), 0);
  const Bank bank = cdf97_bank();
  const auto step = [&](std::vector<double>& line, std::vector<double>& out) {
    line_step(line, out, bank);
  };
  const bool first = order == Order::kFinestFirst;
  for (int i = 0; i < levels; ++i) {
    const int l = first ? i : levels - 1 - i;
    const int w = image.width() >> l, h = image.height() >> l;
    over_lines(image, w, h, first ? Lines::kRows : Lines::kColumns, step);
    over_lines(image, w, h, first ? Lines::kColumns : Lines::kRows, step);
  }
}

}  // namespace

Plane padded_for_transform(const Plane& image, int levels) {
  const int step = 1 << levels;
  Plane result((image.width() + step - 1) / step * step, (image.height() + step - 1) / step * step);
  parallel_rows(0, result.height(), [&](int y) {
    for (int x = 0; x < result.width(); ++x) {
      result(x, y) = image(extend_symmetric(x, image.width()), extend_symmetric(y, image.height()));
    }
  });
  return result;
}

void forward_transform(Plane& image, int levels, TransformOf of) {
  over_levels(image, levels, Order::kFinestFirst,
              [&](std::vector<double>& line, std::vector<double>& out, const Bank& bank) {
                split_line(line, out, bank, of);
              });
}

void inverse_transform(Plane& image, int levels) {
  over_levels(image, levels, Order::kFinestLast, join_line);
}

void transposed_forward_transform(Plane& image, int levels) {
  over_levels(image, levels, Order::kFinestLast, split_line_transposed);
}

void transposed_inverse_transform(Plane& image, int levels) {
  over_levels(image, levels, Order::kFinestFirst, join_line_transposed);
}

}  // namespace spool
