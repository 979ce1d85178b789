#include "lib/pyramid/row_sums.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lib/core/vector_clones.h"

namespace spool {

namespace {

// Partial sums stay in registers for three and five terms, the filters of the pyramid; longer sums
// go eight terms a sweep.
template <class T>
SPOOL_VECTOR_CLONES void weighted_sum(const T* const* sources, const T* weights, std::size_t terms,
                                      int width, T* __restrict out) {
  const T *a = sources[0], *b = a, *c = a, *d = a, *e = a;
  T wa = weights[0], wb = wa, wc = wa, wd = wa, we = wa;
  if (terms > 1) b = sources[1], wb = weights[1];
  if (terms > 2) c = sources[2], wc = weights[2];
  if (terms > 3) d = sources[3], wd = weights[3];
  if (terms > 4) e = sources[4], we = weights[4];
  std::size_t i = 5;
  if (terms == 3) {
    for (int x = 0; x < width; ++x)
      out[x] = wa * a[x] + wb * b[x] + wc * c[x];
    return;
  }
  if (terms >= 5) {
    for (int x = 0; x < width; ++x)
      out[x] = wa * a[x] + wb * b[x] + wc * c[x] + wd * d[x] + we * e[x];
  } else {
    for (int x = 0; x < width; ++x)
      out[x] = wa * a[x];
    i = 1;
  }
  for (; i + 8 <= terms; i += 8) {
    const T* const* f = sources + i;
    const T* w = weights + i;
    const T *f0 = f[0], *f1 = f[1], *f2 = f[2], *f3 = f[3], *f4 = f[4], *f5 = f[5], *f6 = f[6],
            *f7 = f[7];
    const T w0 = w[0], w1 = w[1], w2 = w[2], w3 = w[3], w4 = w[4], w5 = w[5], w6 = w[6], w7 = w[7];
    for (int x = 0; x < width; ++x) {
      out[x] = out[x] + w0 * f0[x] + w1 * f1[x] + w2 * f2[x] + w3 * f3[x] + w4 * f4[x] +
               w5 * f5[x] + w6 * f6[x] + w7 * f7[x];
    }
  }
  for (; i + 4 <= terms; i += 4) {
    a = sources[i], b = sources[i + 1], c = sources[i + 2], d = sources[i + 3];
    wa = weights[i], wb = weights[i + 1], wc = weights[i + 2], wd = weights[i + 3];
    for (int x = 0; x < width; ++x)
      out[x] = out[x] + wa * a[x] + wb * b[x] + wc * c[x] + wd * d[x];
  }
  for (; i < terms; ++i) {
    a = sources[i];
    wa = weights[i];
    for (int x = 0; x < width; ++x)
      out[x] = out[x] + wa * a[x];
  }
}

// A number of terms that is known before, three or five, in one sweep over a block of rows; other
// numbers row by row.
template <class T, std::size_t... Terms>
SPOOL_VECTOR_CLONES void sums_of(std::index_sequence<Terms...>, const T* from,
                                 std::ptrdiff_t stride, std::ptrdiff_t t, const T* weights,
                                 int rows, int width, T* __restrict out,
                                 std::ptrdiff_t out_stride) {
  const T w[] = {weights[Terms]...};
  for (int r = 0; r < rows; ++r, from += stride, out += out_stride) {
    for (int x = 0; x < width; ++x)
      out[x] = (... + (w[Terms] * from[x + static_cast<std::ptrdiff_t>(Terms) * t]));
  }
}

template <class T>
void weighted_block(const T* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride,
                    const T* weights, std::size_t terms, int rows, int width, T* __restrict out,
                    std::ptrdiff_t out_stride) {
  if (terms == 3)
    return sums_of(std::make_index_sequence<3>(), from, stride, term_stride, weights, rows, width,
                   out, out_stride);
  if (terms == 5)
    return sums_of(std::make_index_sequence<5>(), from, stride, term_stride, weights, rows, width,
                   out, out_stride);
  std::vector<const T*> sources(terms);
  for (int r = 0; r < rows; ++r) {
    for (std::size_t i = 0; i < terms; ++i)
      sources[i] = from + r * stride + static_cast<std::ptrdiff_t>(i) * term_stride;
    weighted_sum(sources.data(), weights, terms, width, out + r * out_stride);
  }
}

// The same without weights.
template <std::size_t... Terms>
SPOOL_VECTOR_CLONES void plain_sums_of(std::index_sequence<Terms...>, const double* from,
                                       std::ptrdiff_t stride, std::ptrdiff_t t, int rows, int width,
                                       double* __restrict out, std::ptrdiff_t out_stride) {
  for (int r = 0; r < rows; ++r, from += stride, out += out_stride) {
    for (int x = 0; x < width; ++x)
      out[x] = (... + from[x + static_cast<std::ptrdiff_t>(Terms) * t]);
  }
}

// Other numbers of terms: four a sweep.
SPOOL_VECTOR_CLONES
void sum_of_shifted_rows(const double* from, std::ptrdiff_t s, int terms, int width,
                         double* __restrict out) {
  int i = 1;
  if (terms >= 4) {
    for (int x = 0; x < width; ++x)
      out[x] = from[x] + from[x + s] + from[x + 2 * s] + from[x + 3 * s];
    i = 4;
  } else {
    std::copy_n(from, width, out);
  }
  for (; i + 4 <= terms; i += 4) {
    const double* f = from + i * s;
    for (int x = 0; x < width; ++x)
      out[x] = out[x] + f[x] + f[x + s] + f[x + 2 * s] + f[x + 3 * s];
  }
  for (; i < terms; ++i) {
    const double* f = from + i * s;
    for (int x = 0; x < width; ++x)
      out[x] += f[x];
  }
}

}  // namespace

void weighted_sums(const double* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride,
                   const double* weights, std::size_t terms, int rows, int width,
                   double* __restrict out, std::ptrdiff_t out_stride) {
  weighted_block(from, stride, term_stride, weights, terms, rows, width, out, out_stride);
}
void weighted_sums(const float* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride,
                   const float* weights, std::size_t terms, int rows, int width,
                   float* __restrict out, std::ptrdiff_t out_stride) {
  weighted_block(from, stride, term_stride, weights, terms, rows, width, out, out_stride);
}

void plain_sums(const double* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride, int terms,
                int rows, int width, double* __restrict out, std::ptrdiff_t out_stride) {
  const auto sum = [&](auto count) {
    plain_sums_of(count, from, stride, term_stride, rows, width, out, out_stride);
  };
  switch (terms) {
    case 2:
      return sum(std::make_index_sequence<2>());
    case 4:
      return sum(std::make_index_sequence<4>());
    case 8:
      return sum(std::make_index_sequence<8>());
    case 16:
      return sum(std::make_index_sequence<16>());
    default:
      for (int r = 0; r < rows; ++r)
        sum_of_shifted_rows(from + r * stride, term_stride, terms, width, out + r * out_stride);
  }
}

void weighted_sum_of_rows(const double* const* sources, const double* weights, std::size_t terms,
                          int width, double* __restrict out) {
  weighted_sum(sources, weights, terms, width, out);
}
void weighted_sum_of_rows(const float* const* sources, const float* weights, std::size_t terms,
                          int width, float* __restrict out) {
  weighted_sum(sources, weights, terms, width, out);
}

}  // namespace spool
