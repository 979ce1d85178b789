#include "lib/filters/twin_guides/window_fit.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "lib/core/eight_floats.h"
#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/robust_limit.h"

namespace spool {
namespace {

constexpr int kAll = kPosition + static_cast<int>(kMostFeatureChannels);  // rows with features
constexpr int kColours = 6;  // three, and their differences
constexpr float kLeastPivot =
    1e-5f;  // of the sum of the weights; below it float has no digits left

// The window of one piece: weights, and where its pieces lie in the table.
struct Window {
  int count;
  const float* weight;
  const int* place;
};

constexpr int kBlock = 32;  // pieces of a window that are added together

// Rows of equations that the registers hold; with AVX-512 there are twice as many of twice the
// width.
template <class Vector>
inline constexpr int kInRegisters = kFloats<Vector> == kLanes ? 10 : 5;

// Lanes of pieces of a window, less the centre's and once more times their weight.
struct Block {
  Piece pieces[kBlock], weighted[kBlock];
};

// equations += sum w u u of `rows` rows from `first` on.
template <class Vector, int kCount>
[[gnu::always_inline]] inline void add_rows(const Block& block, int pieces, int first,
                                            float* equations) {
  constexpr int kParts = kLanes / kFloats<Vector>;
  Vector sum[kCount][kParts], u[kParts];
  std::memcpy(sum, equations + first * kLanes, sizeof(sum));
  for (int i = 0; i < pieces; ++i) {
    std::memcpy(u, block.pieces[i].lanes, sizeof(u));
#pragma GCC unroll 10
    for (int r = 0; r < kCount; ++r) {
      const float factor = block.weighted[i].lanes[first + r];
#pragma GCC unroll 2
      for (int part = 0; part < kParts; ++part)
        sum[r][part] += factor * u[part];
    }
  }
  std::memcpy(equations + first * kLanes, sum, sizeof(sum));
}

// The kRows x kLanes normal equations, sum w u (u, y); `centre` is what the piece's own
// lanes are less (clean features, its colour), y is limited first.
template <class Vector, int kRows>
[[gnu::always_inline]] inline void add_equations(const Window& window, const FitTable& table,
                                                 const float* centre, float top, float* equations) {
  Block block;
  const float *lanes = table.lanes(), *luminance = table.luminances();
  const Vector zero{};
  for (int i = 0; i < kRows * kLanes; i += kFloats<Vector>)
    std::memcpy(equations + i, &zero, sizeof(Vector));
  for (int begin = 0; begin < window.count; begin += kBlock) {
    const int pieces = std::min(kBlock, window.count - begin);
    for (int i = 0; i < pieces; ++i) {
      const int place = window.place[begin + i];
      const float weight = window.weight[begin + i];
      const float* from = lanes + static_cast<std::ptrdiff_t>(place) * kLanes;
      Piece limited;
      if (luminance[place] > top) {
        const float factor = top / luminance[place];
        for (int c = 0; c < kLanes; ++c)
          limited.lanes[c] = from[c] * (c >= kRows && c < kRows + kColours ? factor : 1.0f);
        from = limited.lanes;
      }
      for (int c = 0; c < kLanes; c += kFloats<Vector>) {
        Vector u, off;
        std::memcpy(&u, from + c, sizeof(Vector));
        std::memcpy(&off, centre + c, sizeof(Vector));
        u -= off;
        std::memcpy(block.pieces[i].lanes + c, &u, sizeof(Vector));
        u *= weight;
        std::memcpy(block.weighted[i].lanes + c, &u, sizeof(Vector));
      }
    }
    constexpr int kTogether = std::min(kRows, kInRegisters<Vector>);
    static_assert(kRows % kTogether == 0);
    for (int first = 0; first < kRows; first += kTogether)
      add_rows<Vector, kTogether>(block, pieces, first, equations);
  }
}

SPOOL_VECTOR_WIDTHS(void add_normal_equations(const Window& window, const FitTable& table,
                                              const float* centre, float top, float* equations),
                    (table.rows() == kPosition
                         ? add_equations<Vector, kPosition>(window, table, centre, top, equations)
                         : add_equations<Vector, kAll>(window, table, centre, top, equations)))

// Coefficient 0 of each colour and difference into value[kColours]; false where its pivot is lost
// in rounding.
template <int kRows>
SPOOL_VECTOR_CLONES bool solve_for_constant(float* equations, float ridge, float* value) {
  Lanes a[kRows];
  std::memcpy(a, equations, sizeof(a));
  const float weight = a[0][0];
  for (int r = 1; r < kRows; ++r)
    a[r][r] += ridge;
  for (int r = kRows - 1; r > 0; --r) {
    const float inverse = 1.0f / a[r][r];
    for (int j = 0; j < r; ++j)
      a[j] -= (a[j][r] * inverse) * a[r];
  }
  if (!(a[0][0] > kLeastPivot * weight)) return false;
  for (int c = 0; c < kColours; ++c)
    value[c] = a[0][kRows + c] / a[0][0];
  return true;
}

// Of one tile.
class TileFit {
 public:
  TileFit(const WindowWeights& weights, const FitTable& table, double ridge)
      : weights_(weights), table_(table), ridge_(static_cast<float>(ridge)) {
    for (const auto [dx, dy] : weights.offsets())
      steps_.push_back(table.step(dx, dy));
    weight_.resize(steps_.size());
    place_.resize(steps_.size());
    rows_.resize(steps_.size());
  }

  void begin_row(int x, int y) {
    for (std::size_t o = 0; o < steps_.size(); ++o)
      rows_[o] = weights_.row(o, x, y);
  }

  // The piece (x, y), the i-th of the row: colours, then differences. `features`: its clean ones.
  std::array<float, kColours> fit(int x, int y, int i, float top,
                                  const std::array<float, kMostFeatureChannels>& features) {
    const int place = table_.place(x, y);
    const Window window = gather(i, place);
    const std::array<float, 3> own = limited(place, top);
    const auto colours = static_cast<std::size_t>(table_.rows());
    alignas(Piece) std::array<float, kLanes> centre{0.0f, table_.down(y), table_.right(x)};
    if (table_.rows() > kPosition)
      std::copy(features.begin(), features.end(), centre.begin() + kPosition);
    for (std::size_t c = 0; c < 3; ++c)
      centre[(table_.rows() > kPosition ? kAll : kPosition) + c] = own[c];
    alignas(Piece) std::array<float, kLanes*(kPosition + kMostFeatureChannels)> equations;
    std::array<float, kColours> value;
    add_normal_equations(window, table_, centre.data(), top, equations.data());
    const bool solved = table_.rows() == kPosition
                            ? solve_for_constant<kPosition>(equations.data(), ridge_, value.data())
                            : solve_for_constant<kAll>(equations.data(), ridge_, value.data());
    if (!solved) {  // the weighted mean
      for (std::size_t c = 0; c < value.size(); ++c)
        value[c] = equations[colours + c] / equations[0];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      value[c] += own[c];
      if (value[c] < 0.0f) value[c] = std::max(value[c], std::min(0.0f, least(window, top, c)));
    }
    return value;
  }

 private:
  Window gather(int x, int centre) {
    int count = 0;
    for (std::size_t o = 0; o < steps_.size(); ++o) {
      const float w = rows_[o][x];
      weight_[static_cast<std::size_t>(count)] = w;
      place_[static_cast<std::size_t>(count)] = centre + steps_[o];
      count += w > 0.0f ? 1 : 0;
    }
    return {count, weight_.data(), place_.data()};
  }

  // Colour of a piece of the table under the limit.
  std::array<float, 3> limited(int place, float top) const {
    const float* colour = table_.lanes(place) + table_.rows();
    const float l = table_.luminances()[place];
    const float factor = l > top ? top / l : 1.0f;
    return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
  }

  float least(const Window& window, float top, std::size_t c) const {
    float smallest = limited(window.place[0], top)[c];
    for (int i = 1; i < window.count; ++i)
      smallest = std::min(smallest, limited(window.place[i], top)[c]);
    return smallest;
  }

  const WindowWeights& weights_;
  const FitTable& table_;
  float ridge_;
  std::vector<int> steps_;          // [offset] in the table
  std::vector<const float*> rows_;  // [offset] weights of the row at hand
  std::vector<float> weight_;
  std::vector<int> place_;
};

}  // namespace

void window_fit(const Lattice& lattice, const Rectangle& tile, const WindowWeights& weights,
                const FitTable& table, const ScaleInputs& inputs, const FeatureImages& clean,
                const CountImage& n, const FitOptions& options, ScaleImages& to) {
  const Image<float> tops = robust_limits(lattice, tile, weights, table, inputs.log_luminance, n,
                                          options.heavy, options.limit);
  TileFit fit(weights, table, options.ridge);
  for (int y = tile.y0; y < tile.y1; ++y) {
    fit.begin_row(tile.x0, y);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const std::size_t piece = n.index(lattice.column(x), lattice.row(y));
      std::array<float, kMostFeatureChannels> features{};
      for (std::size_t c = 0; c < clean.value.size(); ++c)
        features[c] = clean.value[c][piece];
      const std::array<float, kColours> value =
          fit.fit(x, y, x - tile.x0, tops(x - tile.x0, y - tile.y0), features);
      for (std::size_t c = 0; c < 3; ++c) {
        to.image[c][piece] = value[c];
        to.noise[c][piece] = value[c + 3];
      }
    }
  }
}

}  // namespace spool
