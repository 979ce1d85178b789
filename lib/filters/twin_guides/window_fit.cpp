#include "lib/filters/twin_guides/window_fit.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "lib/core/vector_clones.h"
#include "lib/filters/twin_guides/robust_limit.h"

namespace spool {
namespace {

constexpr int kLanes = 16;            // regressors, then the three colours, then nothing
constexpr int kPosition = 3;          // rows of a fit without features: 1, y, x
constexpr float kPerPosition = 0.1f;  // 1 / 10 pieces
constexpr float kLeastPivot = 1e-5f;  // of the sum of the weights; below it float says nothing
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));

// The window of one piece: weights, and where its pieces lie in the table of regressors.
struct Window {
  int count;
  const float* weight;
  const int* place;
};

// A piece's row of the table: regressors and colours, and its luminance.
struct Table {
  const float* lanes;      // [piece][kLanes]
  const float* luminance;  // [piece]
};

// Adds sum w u (u, y) to the kRows x kLanes normal equations; `centre` is what the piece's own
// lanes are less (clean features, its colour), y is limited first.
template <int kRows>
SPOOL_VECTOR_CLONES void add_normal_equations(const Window& window, const Table& table,
                                              const float* centre, float top, float* equations) {
  Lanes sums[kRows];
  for (int r = 0; r < kRows; ++r)
    sums[r] = Lanes{};
  Lanes off;
  std::memcpy(&off, centre, sizeof(Lanes));
  for (int i = 0; i < window.count; ++i) {
    const int place = window.place[i];
    Lanes u;
    std::memcpy(&u, table.lanes + static_cast<std::ptrdiff_t>(place) * kLanes, sizeof(Lanes));
    if (table.luminance[place] > top) {
      const float factor = top / table.luminance[place];
      u[kRows] *= factor;
      u[kRows + 1] *= factor;
      u[kRows + 2] *= factor;
    }
    u -= off;
    const Lanes weighted = window.weight[i] * u;
    float factors[kLanes];  // from memory a lane is spread over a vector without a shuffle
    std::memcpy(factors, &weighted, sizeof(Lanes));
#pragma GCC unroll 10
    for (int r = 0; r < kRows; ++r)
      sums[r] += factors[r] * u;
  }
  std::memcpy(equations, sums, sizeof(sums));
}

// Coefficient 0 of each colour into value[3]; false where its pivot is lost in rounding.
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
  for (int c = 0; c < 3; ++c)
    value[c] = a[0][kRows + c] / a[0][0];
  return true;
}

class TileFit {
 public:
  TileFit(const Rectangle& tile, const WindowWeights& weights, const SampleMoments& moments,
          const CleanFeatures& features, const TwinGuidesOptions& options)
      : tile_(tile),
        weights_(weights),
        features_(features),
        around_(grow(tile, options.radius, options.radius, options.radius, options.radius,
                     moments.mean[0].bounds())),
        rows_(features.raw.empty() ? kPosition
                                   : kPosition + static_cast<int>(kMostFeatureChannels)),
        ridge_(static_cast<float>(options.ridge)) {
    fill_table(moments);
    for (const auto [dx, dy] : weights.offsets())
      steps_.push_back(dy * around_.width() + dx);
    weight_.resize(steps_.size());
    place_.resize(steps_.size());
  }

  FloatRgb run(const Image<float>& tops) {
    FloatRgb out;
    out.fill(Image<float>(tile_.width(), tile_.height()));
    std::vector<const float*> weight_rows(steps_.size());
    for (int y = 0; y < tile_.height(); ++y) {
      for (std::size_t o = 0; o < steps_.size(); ++o)
        weight_rows[o] = weights_.row(o, tile_.x0, tile_.y0 + y);
      for (int x = 0; x < tile_.width(); ++x) {
        const Window window = gather(weight_rows.data(), x, place_of(x, y));
        const std::array<float, 3> value = fit(window, x, y, tops(x, y));
        for (std::size_t c = 0; c < 3; ++c)
          out[c](x, y) = value[c];
      }
    }
    return out;
  }

 private:
  // Of a piece of the tile in the table.
  int place_of(int x, int y) const {
    return (y + tile_.y0 - around_.y0) * around_.width() + (x + tile_.x0 - around_.x0);
  }

  void fill_table(const SampleMoments& moments) {
    const auto pieces = static_cast<std::size_t>(around_.area());
    lanes_.assign(pieces * kLanes, 0.0f);
    luminance_.resize(pieces);
    std::size_t piece = 0;
    for (int y = around_.y0; y < around_.y1; ++y) {
      for (int x = around_.x0; x < around_.x1; ++x, ++piece) {
        float* u = &lanes_[piece * kLanes];
        u[0] = 1.0f;
        u[1] = kPerPosition * static_cast<float>(y - tile_.y0);
        u[2] = kPerPosition * static_cast<float>(x - tile_.x0);
        for (std::size_t c = 0; c < features_.raw.size(); ++c)
          u[kPosition + static_cast<int>(c)] = features_.raw[c](x, y);
        float* colour = u + rows_;
        for (std::size_t c = 0; c < 3; ++c)
          colour[c] = moments.mean[c](x, y);
        luminance_[piece] = static_cast<float>(luminance(colour[0], colour[1], colour[2]));
      }
    }
  }

  Window gather(const float* const* weight_rows, int x, int centre) {
    int count = 0;
    for (std::size_t o = 0; o < steps_.size(); ++o) {
      const float w = weight_rows[o][x];
      weight_[static_cast<std::size_t>(count)] = w;
      place_[static_cast<std::size_t>(count)] = centre + steps_[o];
      count += w > 0.0f ? 1 : 0;
    }
    return {count, weight_.data(), place_.data()};
  }

  // Colour of a piece of the table under the limit.
  std::array<float, 3> limited(int place, float top) const {
    const float* colour = &lanes_[static_cast<std::size_t>(place) * kLanes] + rows_;
    const float l = luminance_[static_cast<std::size_t>(place)];
    const float factor = l > top ? top / l : 1.0f;
    return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
  }

  std::array<float, 3> fit(const Window& window, int x, int y, float top) const {
    const int place = place_of(x, y);
    const std::array<float, 3> own = limited(place, top);
    std::array<float, kLanes> centre{};
    std::copy_n(&lanes_[static_cast<std::size_t>(place) * kLanes], kPosition, centre.data());
    centre[0] = 0.0f;
    for (std::size_t c = 0; c < features_.raw.size(); ++c)
      centre[kPosition + c] = features_.clean.value[c](tile_.x0 + x, tile_.y0 + y);
    std::copy(own.begin(), own.end(), centre.begin() + rows_);
    const Table table{lanes_.data(), luminance_.data()};
    std::array<float, kLanes*(kPosition + kMostFeatureChannels)> equations;
    std::array<float, 3> value;
    bool solved;
    if (rows_ == kPosition) {
      add_normal_equations<kPosition>(window, table, centre.data(), top, equations.data());
      solved = solve_for_constant<kPosition>(equations.data(), ridge_, value.data());
    } else {
      constexpr int kAll = kPosition + static_cast<int>(kMostFeatureChannels);
      add_normal_equations<kAll>(window, table, centre.data(), top, equations.data());
      solved = solve_for_constant<kAll>(equations.data(), ridge_, value.data());
    }
    for (std::size_t c = 0; c < 3; ++c) {
      // Without a fit the weighted mean.
      if (!solved) value[c] = equations[static_cast<std::size_t>(rows_) + c] / equations[0];
      value[c] += own[c];
      if (value[c] < 0.0f) value[c] = std::max(value[c], std::min(0.0f, least(window, top, c)));
    }
    return value;
  }

  float least(const Window& window, float top, std::size_t c) const {
    float smallest = limited(window.place[0], top)[c];
    for (int i = 1; i < window.count; ++i)
      smallest = std::min(smallest, limited(window.place[i], top)[c]);
    return smallest;
  }

  Rectangle tile_;
  const WindowWeights& weights_;
  const CleanFeatures& features_;
  Rectangle around_;  // the tile and its windows inside the image
  int rows_;          // of the normal equations
  float ridge_;
  std::vector<float> lanes_, luminance_;  // of the pieces of around_
  std::vector<int> steps_;                // [offset] in the table
  std::vector<float> weight_;
  std::vector<int> place_;
};

}  // namespace

FloatRgb window_fit(const Rectangle& tile, const WindowWeights& weights,
                    const SampleMoments& moments, const CountImage& n,
                    const CleanFeatures& features, const TwinGuidesOptions& options) {
  const Image<float> tops = robust_limits(tile, weights, moments.log_luminance, n, options.limit);
  return TileFit(tile, weights, moments, features, options).run(tops);
}

}  // namespace spool
