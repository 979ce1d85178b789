#include "lib/kernels/pair_filter.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

// A plane and its neighbour in rows that begin at the same piece: p, and q some pieces further.
struct Row {
  const float *p, *q;
};

Row row_of(const Image<float>& image, int x, int y, int dx, int dy) {
  return {&image(x, y), &image(x + dx, y + dy)};
}

// passed[x]: all bits, and none where the test of one plane says no.
SPOOL_VECTOR_CLONES
void test_row(Row mean, Row half2, float kappa, int width, std::uint32_t* __restrict passed) {
  for (int x = 0; x < width; ++x) {
    const float d = mean.p[x] - mean.q[x];
    const float own = kappa * half2.p[x], other = half2.q[x];
    const float bound = half2.p[x] + (own < other ? own : other);
    passed[x] &= d * d <= bound ? ~0u : 0u;
  }
}

SPOOL_VECTOR_CLONES
void add_feature_row(Row value, Row variance, int width, float* __restrict distance) {
  for (int x = 0; x < width; ++x) {
    const float d = value.p[x] - value.q[x], v = variance.p[x] + variance.q[x];
    const float e = d * d - v;
    distance[x] += (e > 0.0f ? e : 0.0f) / (1.0f + 2.0f * v);
  }
}

SPOOL_VECTOR_CLONES
void weights_of_row(const float* distance, const std::uint32_t* passed, const float* count,
                    int width, float* __restrict weight) {
  for (int x = 0; x < width; ++x) {
    const float w = exp_negative(distance[x]) * count[x];
    weight[x] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(w) & passed[x]);
  }
}

SPOOL_VECTOR_CLONES
void add_weights(const float* weight, int width, double* __restrict sum,
                 double* __restrict squares) {
  for (int x = 0; x < width; ++x) {
    const auto w = static_cast<double>(weight[x]);
    sum[x] += w;
    squares[x] += w * w;
  }
}

SPOOL_VECTOR_CLONES
void add_values(const float* weight, const double* value, int width, double* __restrict sum) {
  for (int x = 0; x < width; ++x)
    sum[x] += static_cast<double>(weight[x]) * value[x];
}

class RowFilter {
 public:
  RowFilter(const std::vector<const Plane*>& values, const PairTest& test,
            const PairFeatures& features, const Image<float>& count, const PairWindow& window)
      : values_(values), test_(test), features_(features), count_(count), window_(window) {}

  void run(int y, PairMeans& means) const {
    const int r = window_.radius;
    std::vector<float> distance(static_cast<std::size_t>(count_.width()));
    std::vector<float> weight(distance);
    std::vector<std::uint32_t> passed(distance.size());
    for (int dy = std::max(-r, -y); dy <= std::min(r, count_.height() - 1 - y); ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        if (dx * dx + dy * dy > r * r) continue;
        const int x0 = std::max(0, -dx), width = std::min(count_.width(), count_.width() - dx) - x0;
        if (width <= 0) continue;
        weigh({x0, y}, {dx, dy}, width, distance, passed, weight);
        add_weights(weight.data(), width, &means.weight(x0, y), &means.weight2(x0, y));
        for (std::size_t i = 0; i < values_.size(); ++i) {
          add_values(weight.data(), &(*values_[i])(x0 + dx, y + dy), width, &means.value[i](x0, y));
        }
      }
    }
    finish(y, means);
  }

  struct Place {
    int x, y;
  };
  struct Weight {
    Place from;
    double weight;
  };

  // Of one piece, not yet over their sum: those above 0.
  std::vector<Weight> weights_of(Place at) const {
    const int r = window_.radius;
    std::vector<float> distance(1), weight(1);
    std::vector<std::uint32_t> passed(1);
    std::vector<Weight> weights;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        const Place from{at.x + dx, at.y + dy};
        if (dx * dx + dy * dy > r * r || !count_.bounds().contains(from.x, from.y)) continue;
        weigh(at, {dx, dy}, 1, distance, passed, weight);
        if (weight[0] > 0.0f) weights.push_back({from, weight[0]});
      }
    }
    return weights;
  }

 private:
  void weigh(Place at, Place to, int width, std::vector<float>& distance,
             std::vector<std::uint32_t>& passed, std::vector<float>& weight) const {
    const auto rows = [&](const Image<float>& image) {
      return row_of(image, at.x, at.y, to.x, to.y);
    };
    const double spatial = (to.x * to.x + to.y * to.y) / (2.0 * window_.sigma * window_.sigma);
    std::fill_n(distance.begin(), width, static_cast<float>(spatial));
    std::fill_n(passed.begin(), width, ~0u);
    if (to.x != 0 || to.y != 0) {
      for (std::size_t k = 0; k < test_.mean.size(); ++k) {
        test_row(rows(test_.mean[k]), rows(test_.half2[k]), static_cast<float>(test_.kappa), width,
                 passed.data());
      }
      for (std::size_t c = 0; c < features_.value.size(); ++c)
        add_feature_row(rows(features_.value[c]), rows(features_.variance[c]), width,
                        distance.data());
    }
    weights_of_row(distance.data(), passed.data(), rows(count_).q, width, weight.data());
  }

  static void finish(int y, PairMeans& means) {
    for (Plane& value : means.value) {
      for (int x = 0; x < value.width(); ++x)
        value(x, y) = means.weight(x, y) > 0.0 ? value(x, y) / means.weight(x, y) : 0.0;
    }
  }

  const std::vector<const Plane*>& values_;
  const PairTest& test_;
  const PairFeatures& features_;
  const Image<float>& count_;
  PairWindow window_;
};

}  // namespace

PairMeans pair_filter(const std::vector<const Plane*>& values, const PairTest& test,
                      const PairFeatures& features, const Image<float>& count,
                      const PairWindow& window) {
  const auto zeros = [&] { return Plane(count.width(), count.height()); };
  PairMeans means{std::vector<Plane>(values.size(), zeros()), zeros(), zeros()};
  const RowFilter filter(values, test, features, count, window);
  parallel_rows(0, count.height(), [&](int y) { filter.run(y, means); });
  return means;
}

void add_pair_footprint(const RgbImage& values, const PairTest& test, const PairFeatures& features,
                        const Image<float>& count, const PairWindow& window, int x, int y,
                        double share, int q, Footprint& to) {
  const std::vector<RowFilter::Weight> weights =
      RowFilter({}, test, features, count, window).weights_of({x, y});
  double sum = 0.0;
  for (const auto& [from, weight] : weights)
    sum += weight;
  if (weights.empty()) to.add(x / q, y / q, share, values, values[0].index(x, y));
  for (const auto& [from, weight] : weights)
    to.add(from.x / q, from.y / q, share * weight / sum, values, values[0].index(from.x, from.y));
}

}  // namespace spool
