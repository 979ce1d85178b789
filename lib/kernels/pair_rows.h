// Rows of the pair filter (lib/kernels/pair_filter.h): a block of pieces and, for each, a row of
// the neighbours in its window. Arrays are [neighbour][piece]; neighbour i of piece l lies i + l
// further than the first one of the first piece.
#pragma once

#include <cstddef>
#include <cstdint>

namespace spool {

inline constexpr int kPairBlock = 16;
inline constexpr std::size_t kMostPairValues = 3;  // added up together

// A plane at the block's first piece, and at the first neighbour of a row of the window.
struct PairRow {
  const float *p, *q;
};

// Takes all bits off passed where the test of one plane says no.
void test_row(PairRow mean, PairRow half2, float kappa, int neighbours, std::uint32_t* passed);

// distance = spatial of the neighbour.
void begin_row(const float* spatial, int neighbours, float* distance);
void add_feature_row(PairRow value, PairRow variance, int neighbours, float* distance);
// distance becomes exp(-distance).
void exponentials(float* distance, int count);

// weight = factor times the neighbour's count where the tests were passed.
void weights_of_row(const float* factor, const std::uint32_t* passed, const float* count,
                    int neighbours, float* weight);

// sum += w, squares += w^2.
void add_weights(const float* weight, int neighbours, double* sum, double* squares);
// sums[v] += w times values[v], which is at the first neighbour of the first piece.
void add_values(const float* weight, int neighbours, const double* const* values, std::size_t count,
                double (*sums)[kPairBlock]);

}  // namespace spool
