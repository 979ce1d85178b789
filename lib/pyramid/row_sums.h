// Sums of rows, element by element: what every convolution and every window sum spends its time on.
//
// Terms are added in their order, whatever the vector width. Rows may overlap each other but not
// the output.
#pragma once

#include <cstddef>

namespace spool {

// out[x] = sum_i weights[i] * sources[i][x], for x < width; terms >= 1.
void weighted_sum_of_rows(const double* const* sources, const double* weights, std::size_t terms,
                          int width, double* __restrict out);
void weighted_sum_of_rows(const float* const* sources, const float* weights, std::size_t terms,
                          int width, float* __restrict out);

// The same for many rows whose terms lie at equal distances:
//   out[r * out_stride + x] = sum_i weights[i] * from[r * stride + i * term_stride + x], r < rows.
void weighted_sums(const double* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride,
                   const double* weights, std::size_t terms, int rows, int width,
                   double* __restrict out, std::ptrdiff_t out_stride);
void weighted_sums(const float* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride,
                   const float* weights, std::size_t terms, int rows, int width,
                   float* __restrict out, std::ptrdiff_t out_stride);

// out[r * out_stride + x] = sum over i < terms of from[r * stride + i * term_stride + x].
void plain_sums(const double* from, std::ptrdiff_t stride, std::ptrdiff_t term_stride, int terms,
                int rows, int width, double* __restrict out, std::ptrdiff_t out_stride);

}  // namespace spool
