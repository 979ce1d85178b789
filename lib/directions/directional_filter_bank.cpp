#include "lib/directions/directional_filter_bank.h"

#include <algorithm>
#include <memory>

#include "lib/core/vector_clones.h"
#include "lib/directions/bank_stages.h"
#include "lib/pyramid/row_loop.h"

namespace spool {
namespace {

// Rows of an image with `pad` readable pixels on the left and right of each.
template <class T>
struct Rows {
  T* origin = nullptr;  // pixel (0, 0)
  std::ptrdiff_t stride = 0;
  int width = 0, height = 0, pad = 0;

  T* row(int y) const { return origin + y * stride; }
};

template <class T>
void extend_row(const Rows<T>& rows, int y, Extension extension) {
  T* row = rows.row(y);
  for (int i = 1; i <= rows.pad; ++i) {
    row[-i] = row[extend(-i, rows.width, extension)];
    row[rows.width - 1 + i] = row[extend(rows.width - 1 + i, rows.width, extension)];
  }
}

template <class T>
Rows<T> rows_of(Image<T>& image) {
  return {&image[0], image.width(), image.width(), image.height(), 0};
}

// out[x] = sum_j s_j (plus[j][x] - minus[j][x])
template <class T, int kPairs>
SPOOL_VECTOR_CLONES void odd_sum(const T* const* plus, const T* const* minus, const T* s, int width,
                                 T* __restrict out) {
  for (int x = 0; x < width; ++x) {
    T sum = s[0] * (plus[0][x] - minus[0][x]);
    for (int j = 1; j < kPairs; ++j)
      sum += s[j] * (plus[j][x] - minus[j][x]);
    out[x] = sum;
  }
}

// y+ and y- from x and z = -Bx.
template <class T>
SPOOL_VECTOR_CLONES void half_sums(const T* from, const T* z, int width, T* __restrict plus,
                                   T* __restrict minus) {
  const T half = T(0.5);
  for (int i = 0; i < width; ++i) {
    plus[i] = half * (from[i] - z[i]);
    minus[i] = half * (from[i] + z[i]);
  }
}

template <class T>
class Bank {
 public:
  Bank(const Image<T>& image, const BankOptions& options, std::vector<Image<T>>& bands)
      : options_(options),
        bands_(bands),
        width_(image.width()),
        height_(image.height()),
        pad_((2 * pairs() - 1) * options.dilation) {
    const auto s = sign_coefficients(options.taps);
    s_.assign(s.begin(), s.end());
    // The input and two channels for every stage but the last; twice the pad holds any t of a
    // stage.
    for (int i = 0; i < 1 + 2 * (options.levels - 1); ++i)
      storage_.push_back(allocate());
    t_ = std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width_ + 2 * pad_) *
                                             static_cast<std::size_t>(height_ + 2 * pad_));
    const Rows<T> input = storage(0);
    rows_by_area(0, height_, static_cast<long long>(width_) * height_, [&](int y) {
      std::copy(image.row(y).begin(), image.row(y).end(), input.row(y));
      extend_row(input, y, options_.extension);
    });
  }

  void run() {
    const Rows<T> x = storage(0);
    if (options_.levels == 1) {
      split(x, kHorizontalOrVertical, band(0), band(1));
      return;
    }
    const Rows<T> horizontal = storage(1), vertical = storage(2);
    split(x, kHorizontalOrVertical, horizontal, vertical);
    if (options_.levels == 2) {
      split(horizontal, kDiagonal, band(0), band(3));
      split(vertical, kDiagonal, band(1), band(2));
      return;
    }
    const Rows<T> positive = storage(3), negative = storage(4);
    split(horizontal, kDiagonal, positive, negative);
    split(positive, split_of_horizontal(1), band(1), band(0));
    split(negative, split_of_horizontal(-1), band(6), band(7));
    split(vertical, kDiagonal, positive, negative);
    split(positive, split_of_vertical(1), band(2), band(3));
    split(negative, split_of_vertical(-1), band(5), band(4));
  }

 private:
  int pairs() const { return static_cast<int>(sign_coefficients(options_.taps).size()); }

  std::unique_ptr<T[]> allocate() const {
    return std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width_ + 2 * pad_) *
                                               static_cast<std::size_t>(height_));
  }
  Rows<T> storage(std::size_t i) const {
    const std::ptrdiff_t stride = width_ + 2 * pad_;
    return {storage_[i].get() + pad_, stride, width_, height_, pad_};
  }
  Rows<T> band(std::size_t i) const { return rows_of(bands_[i]); }

  // y+ and y- of x; their pads are filled where they have any.
  void split(const Rows<T>& x, BankStage stage, const Rows<T>& plus, const Rows<T>& minus) {
    for_each_product_row(x, stage, [&](int y, const T* z) {
      half_sums(x.row(y), z, width_, plus.row(y), minus.row(y));
      extend_row(plus, y, options_.extension);
      extend_row(minus, y, options_.extension);
    });
  }

  // finish(y, z) for every row y, where z = -Bx on that row.
  template <class Finish>
  void for_each_product_row(const Rows<T>& x, BankStage stage, Finish&& finish) {
    const BankVector p = options_.dilation * stage.p, q = options_.dilation * stage.q;
    const BankVector centre = {(p.x + q.x) / 2, (p.y + q.y) / 2};
    // t(m) = sum_a tap(a) x(m - a p) wherever z(n) = sum_b tap(b) t(n - centre - b q) reads it.
    const auto span = [&](int step, int offset) {
      const int a = -offset + pairs() * step, b = -offset - (pairs() - 1) * step;
      return std::pair{std::min(a, b), std::max(a, b)};
    };
    const auto [left, right] = span(q.x, centre.x);
    const auto [up, down] = span(q.y, centre.y);
    const std::ptrdiff_t stride = width_ + right - left;
    const Rows<T> t = {t_.get() - left - up * stride, stride, width_, height_, 0};

    const long long area = static_cast<long long>(width_) * height_;
    rows_by_area(up, height_ + down, area, [&](int y) {
      odd_sum_along(p, static_cast<int>(stride), t.row(y) + left, [&](int shift_x, int shift_y) {
        return x.row(extend(y + shift_y, height_, options_.extension)) + left + shift_x;
      });
    });
    rows_by_area(0, height_, area, [&](int y) {
      const auto z = std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width_));
      odd_sum_along(q, width_, z.get(), [&](int shift_x, int shift_y) {
        return t.row(y - centre.y + shift_y) - centre.x + shift_x;
      });
      finish(y, z.get());
    });
  }

  // out = sum_j s_j (row shifted by -j v, less row shifted by +(j + 1) v)
  template <class Source>
  void odd_sum_along(BankVector v, int width, T* out, Source&& source) {
    const T* plus[6];
    const T* minus[6];
    for (int j = 0; j < pairs(); ++j) {
      plus[j] = source(-j * v.x, -j * v.y);
      minus[j] = source((j + 1) * v.x, (j + 1) * v.y);
    }
    switch (pairs()) {
      case 3:
        return odd_sum<T, 3>(plus, minus, s_.data(), width, out);
      case 4:
        return odd_sum<T, 4>(plus, minus, s_.data(), width, out);
      default:
        return odd_sum<T, 6>(plus, minus, s_.data(), width, out);
    }
  }

  const BankOptions options_;
  std::vector<Image<T>>& bands_;
  int width_ = 0, height_ = 0, pad_ = 0;
  std::vector<T> s_;
  std::vector<std::unique_ptr<T[]>> storage_;
  std::unique_ptr<T[]> t_;
};

}  // namespace

int detail_dilation(int k) {
  SPOOL_CHECK_GE(k, 0);
  return k <= 1 ? 1 : 1 << (k - 1);
}

int band_count(const BankOptions& options) {
  return 1 << options.levels;
}

template <class T>
std::vector<Image<T>> directional_bands(const Image<T>& image, const BankOptions& options) {
  std::vector<Image<T>> bands;
  directional_bands(image, options, bands);
  return bands;
}

template <class T>
void directional_bands(const Image<T>& image, const BankOptions& options,
                       std::vector<Image<T>>& bands) {
  SPOOL_CHECK_GE(options.levels, 0);
  SPOOL_CHECK_LE(options.levels, 3);
  SPOOL_CHECK_GE(options.dilation, 1);
  bands.resize(static_cast<std::size_t>(band_count(options)));
  if (bands.size() == 1 || image.empty()) {
    for (Image<T>& band : bands)
      band = image;
    return;
  }
  for (Image<T>& band : bands) {
    if (!band.same_size(image)) band = Image<T>(image.width(), image.height());
  }
  Bank<T>(image, options, bands).run();
}

template std::vector<Image<double>> directional_bands(const Image<double>&, const BankOptions&);
template std::vector<Image<float>> directional_bands(const Image<float>&, const BankOptions&);
template void directional_bands(const Image<double>&, const BankOptions&,
                                std::vector<Image<double>>&);
template void directional_bands(const Image<float>&, const BankOptions&,
                                std::vector<Image<float>>&);

OptionTable<BankOptions> bank_option_table() {
  using O = BankOptions;
  return {
      integer_option<O>("bank_levels", &O::levels, 0, 3, "stages of the bank: 2^levels directions"),
      expert(choice_option<O, SignTaps>(
          "bank_taps", &O::taps,
          {{"pkva12", SignTaps::kPkva12}, {"pkva8", SignTaps::kPkva8}, {"pkva6", SignTaps::kPkva6}},
          "sign filter of the bank")),
  };
}

}  // namespace spool
