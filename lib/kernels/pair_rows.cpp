#include "lib/kernels/pair_rows.h"

#include <cstring>

#include "lib/core/eight_floats.h"
#include "lib/core/exponential.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

template <class Vector>
[[gnu::always_inline]] inline void test_of(PairRow mean, PairRow half2, float kappa, int neighbours,
                                           std::uint32_t* __restrict passed) {
  for (int l = 0; l < kPairBlock; l += kFloats<Vector>) {
    Vector p, h, q, other;
    std::memcpy(&p, mean.p + l, sizeof(Vector));
    std::memcpy(&h, half2.p + l, sizeof(Vector));
    const Vector own = kappa * h;
    for (int i = 0; i < neighbours; ++i) {
      std::memcpy(&q, mean.q + i + l, sizeof(Vector));
      std::memcpy(&other, half2.q + i + l, sizeof(Vector));
      const Vector d = p - q, bound = h + (own < other ? own : other);
      auto pass = d * d <= bound;
      decltype(pass) before;
      std::memcpy(&before, passed + i * kPairBlock + l, sizeof(Vector));
      pass &= before;
      std::memcpy(passed + i * kPairBlock + l, &pass, sizeof(Vector));
    }
  }
}

SPOOL_VECTOR_WIDTHS(void test_row_by_width(PairRow mean, PairRow half2, float kappa, int neighbours,
                                           std::uint32_t* passed),
                    test_of<Vector>(mean, half2, kappa, neighbours, passed))

template <class Vector>
[[gnu::always_inline]] inline void add_feature_of(PairRow value, PairRow variance, int neighbours,
                                                  float* __restrict distance) {
  for (int l = 0; l < kPairBlock; l += kFloats<Vector>) {
    Vector p, vp, q, vq, sum;
    std::memcpy(&p, value.p + l, sizeof(Vector));
    std::memcpy(&vp, variance.p + l, sizeof(Vector));
    for (int i = 0; i < neighbours; ++i) {
      std::memcpy(&q, value.q + i + l, sizeof(Vector));
      std::memcpy(&vq, variance.q + i + l, sizeof(Vector));
      std::memcpy(&sum, distance + i * kPairBlock + l, sizeof(Vector));
      const Vector d = p - q, v = vp + vq, e = d * d - v;
      sum += (e > 0.0f ? e : Vector{}) / (1.0f + 2.0f * v);
      std::memcpy(distance + i * kPairBlock + l, &sum, sizeof(Vector));
    }
  }
}

SPOOL_VECTOR_WIDTHS(void add_feature_row_by_width(PairRow value, PairRow variance, int neighbours,
                                                  float* distance),
                    add_feature_of<Vector>(value, variance, neighbours, distance))

template <class Vector>
[[gnu::always_inline]] inline void weights_of(const float* factor, const std::uint32_t* passed,
                                              const float* count, int neighbours,
                                              float* __restrict weight) {
  for (int i = 0; i < neighbours; ++i) {
    for (int l = 0; l < kPairBlock; l += kFloats<Vector>) {
      Vector w, n;
      decltype(w < n) pass, bits;
      std::memcpy(&w, factor + i * kPairBlock + l, sizeof(Vector));
      std::memcpy(&n, count + i + l, sizeof(Vector));
      std::memcpy(&pass, passed + i * kPairBlock + l, sizeof(Vector));
      w *= n;
      std::memcpy(&bits, &w, sizeof(Vector));
      bits &= pass;
      std::memcpy(weight + i * kPairBlock + l, &bits, sizeof(Vector));
    }
  }
}

SPOOL_VECTOR_WIDTHS(void weights_of_row_by_width(const float* factor, const std::uint32_t* passed,
                                                 const float* count, int neighbours, float* weight),
                    weights_of<Vector>(factor, passed, count, neighbours, weight))

typedef float Four __attribute__((vector_size(4 * sizeof(float))));
typedef double FourDoubles __attribute__((vector_size(4 * sizeof(double))));
typedef double EightDoubles __attribute__((vector_size(8 * sizeof(double))));
template <class Vector>
struct Halves {  // a register of doubles, and as many floats
  typedef Four Floats;
  typedef FourDoubles Doubles;
};
template <>
struct Halves<Sixteen> {
  typedef Eight Floats;
  typedef EightDoubles Doubles;
};

template <class Vector>
[[gnu::always_inline]] inline void add_weights_of(const float* weight, int neighbours,
                                                  double* __restrict sum,
                                                  double* __restrict squares) {
  using Floats = typename Halves<Vector>::Floats;
  using Doubles = typename Halves<Vector>::Doubles;
  for (int l = 0; l < kPairBlock; l += kFloats<Floats>) {
    Doubles s, s2;
    Floats f;
    std::memcpy(&s, sum + l, sizeof(Doubles));
    std::memcpy(&s2, squares + l, sizeof(Doubles));
    for (int i = 0; i < neighbours; ++i) {
      std::memcpy(&f, weight + i * kPairBlock + l, sizeof(Floats));
      const Doubles w = __builtin_convertvector(f, Doubles);
      s += w;
      s2 += w * w;
    }
    std::memcpy(sum + l, &s, sizeof(Doubles));
    std::memcpy(squares + l, &s2, sizeof(Doubles));
  }
}

SPOOL_VECTOR_WIDTHS(void add_weights_by_width(const float* weight, int neighbours, double* sum,
                                              double* squares),
                    add_weights_of<Vector>(weight, neighbours, sum, squares))

template <class Vector, int kValues>
[[gnu::always_inline]] inline void add_values_of(const float* weight, int neighbours,
                                                 const double* const* values,
                                                 double (*__restrict sums)[kPairBlock]) {
  using Floats = typename Halves<Vector>::Floats;
  using Doubles = typename Halves<Vector>::Doubles;
  for (int l = 0; l < kPairBlock; l += kFloats<Floats>) {
    Doubles s[kValues], value;
    Floats f;
#pragma GCC unroll 3
    for (int v = 0; v < kValues; ++v)
      std::memcpy(&s[v], sums[v] + l, sizeof(Doubles));
    for (int i = 0; i < neighbours; ++i) {
      std::memcpy(&f, weight + i * kPairBlock + l, sizeof(Floats));
      const Doubles w = __builtin_convertvector(f, Doubles);
#pragma GCC unroll 3
      for (int v = 0; v < kValues; ++v) {
        std::memcpy(&value, values[v] + i + l, sizeof(Doubles));
        s[v] += w * value;
      }
    }
#pragma GCC unroll 3
    for (int v = 0; v < kValues; ++v)
      std::memcpy(sums[v] + l, &s[v], sizeof(Doubles));
  }
}

template <class Vector>
[[gnu::always_inline]] inline void add_up_to_three(const float* weight, int neighbours,
                                                   const double* const* values, std::size_t count,
                                                   double (*sums)[kPairBlock]) {
  if (count == 1) return add_values_of<Vector, 1>(weight, neighbours, values, sums);
  if (count == 2) return add_values_of<Vector, 2>(weight, neighbours, values, sums);
  add_values_of<Vector, 3>(weight, neighbours, values, sums);
}

SPOOL_VECTOR_WIDTHS(void add_values_by_width(const float* weight, int neighbours,
                                             const double* const* values, std::size_t count,
                                             double (*sums)[kPairBlock]),
                    add_up_to_three<Vector>(weight, neighbours, values, count, sums))

}  // namespace

void test_row(PairRow mean, PairRow half2, float kappa, int neighbours, std::uint32_t* passed) {
  test_row_by_width(mean, half2, kappa, neighbours, passed);
}

void add_feature_row(PairRow value, PairRow variance, int neighbours, float* distance) {
  add_feature_row_by_width(value, variance, neighbours, distance);
}

void weights_of_row(const float* factor, const std::uint32_t* passed, const float* count,
                    int neighbours, float* weight) {
  weights_of_row_by_width(factor, passed, count, neighbours, weight);
}

void add_weights(const float* weight, int neighbours, double* sum, double* squares) {
  add_weights_by_width(weight, neighbours, sum, squares);
}

void add_values(const float* weight, int neighbours, const double* const* values, std::size_t count,
                double (*sums)[kPairBlock]) {
  add_values_by_width(weight, neighbours, values, count, sums);
}

SPOOL_VECTOR_CLONES
void begin_row(const float* spatial, int neighbours, float* __restrict distance) {
  for (int i = 0; i < neighbours; ++i) {
    for (int l = 0; l < kPairBlock; ++l)
      distance[i * kPairBlock + l] = spatial[i];
  }
}

SPOOL_VECTOR_CLONES
void exponentials(float* __restrict distance, int count) {
  for (int i = 0; i < count; ++i)
    distance[i] = exp_negative(distance[i]);
}

}  // namespace spool
