#include "lib/kernels/pair_filter.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/rectangle.h"
#include "lib/kernels/pair_rows.h"

namespace spool {
namespace {

constexpr int kTileWidth = 64, kTileHeight = 32;

// The part of an image that the windows of a tile read, 0 beyond the image: whole blocks.
template <class T>
Image<T> around(const Image<T>& image, const Rectangle& tile, int radius) {
  const int blocks = (tile.width() + kPairBlock - 1) / kPairBlock * kPairBlock;
  Image<T> part(blocks + 2 * radius, tile.height() + 2 * radius);
  const int x0 = tile.x0 - radius, y0 = tile.y0 - radius;
  const Rectangle inside =
      intersect(image.bounds(), {x0, y0, x0 + part.width(), y0 + part.height()});
  for (int y = inside.y0; y < inside.y1; ++y)
    std::copy_n(&image(inside.x0, y), inside.width(), &part(inside.x0 - x0, y - y0));
  return part;
}

template <class T>
std::vector<Image<T>> all_around(const std::vector<Image<T>>& images, const Rectangle& tile,
                                 int radius) {
  std::vector<Image<T>> parts;
  for (const Image<T>& image : images)
    parts.push_back(around(image, tile, radius));
  return parts;
}

// Of neighbours in a row of the window: their distance by where they are, and exp(-distance) for
// every piece of a block.
struct RowOfWindow {
  int reach;
  std::vector<float> spatial, factor;
};

// One tile; pieces count from its corner.
class TileFilter {
 public:
  TileFilter(const std::vector<const Plane*>& values, const PairTest& test,
             const PairFeatures& features, const Image<float>& count, const PairWindow& window,
             const Rectangle& tile)
      : tile_(tile),
        window_(window),
        kappa_(static_cast<float>(test.kappa)),
        mean_(all_around(test.mean, tile, window.radius)),
        half2_(all_around(test.half2, tile, window.radius)),
        feature_(all_around(features.value, tile, window.radius)),
        variance_(all_around(features.variance, tile, window.radius)),
        count_(around(count, tile, window.radius)) {
    for (const Plane* value : values)
      values_.push_back(around(*value, tile, window.radius));
    const auto most = static_cast<std::size_t>(kPairBlock * (2 * window.radius + 1));
    distance_.resize(most);
    weight_.resize(most);
    passed_.resize(most);
    set_window();
  }

  void run(PairMeans& means) {
    for (int y = 0; y < tile_.height(); ++y) {
      for (int x = 0; x < tile_.width(); x += kPairBlock)
        run_block(x, y, means);
    }
  }

  struct Weight {
    int x, y;
    double weight;
  };

  // Of the tile's corner, not yet over their sum: those above 0.
  std::vector<Weight> weights_of_corner() {
    std::vector<Weight> weights;
    for (int dy = -window_.radius; dy <= window_.radius; ++dy) {
      const int reach = weigh(0, 0, dy);
      for (int i = 0; i <= 2 * reach; ++i) {
        if (const float weight = weight_[static_cast<std::size_t>(i * kPairBlock)]; weight > 0.0f)
          weights.push_back({tile_.x0 + i - reach, tile_.y0 + dy, weight});
      }
    }
    return weights;
  }

 private:
  void set_window() {
    const int r = window_.radius;
    for (int dy = -r; dy <= r; ++dy) {
      RowOfWindow row{0, {}, {}};
      while ((row.reach + 1) * (row.reach + 1) + dy * dy <= r * r)
        ++row.reach;
      for (int dx = -row.reach; dx <= row.reach; ++dx) {
        row.spatial.push_back(
            static_cast<float>((dx * dx + dy * dy) / (2.0 * window_.sigma * window_.sigma)));
      }
      const int all = static_cast<int>(row.spatial.size());
      row.factor.resize(row.spatial.size() * kPairBlock);
      begin_row(row.spatial.data(), all, row.factor.data());
      exponentials(row.factor.data(), all * kPairBlock);
      window_rows_.push_back(std::move(row));
    }
  }

  // weight_[i][l] of piece (x + l, y) and its neighbour i - reach further in row y + dy; returns
  // the reach there.
  int weigh(int x, int y, int dy) {
    const int r = window_.radius;
    const RowOfWindow& row = window_rows_[static_cast<std::size_t>(dy + r)];
    const int reach = row.reach, neighbours = 2 * reach + 1;
    const auto rows = [&](const Image<float>& image) {
      return PairRow{&image(x + r, y + r), &image(x + r - reach, y + r + dy)};
    };
    std::fill_n(passed_.begin(), neighbours * kPairBlock, ~0u);
    for (std::size_t k = 0; k < mean_.size(); ++k)
      test_row(rows(mean_[k]), rows(half2_[k]), kappa_, neighbours, passed_.data());
    const float* factor = row.factor.data();
    if (!feature_.empty()) {
      begin_row(row.spatial.data(), neighbours, distance_.data());
      for (std::size_t c = 0; c < feature_.size(); ++c)
        add_feature_row(rows(feature_[c]), rows(variance_[c]), neighbours, distance_.data());
      if (dy == 0) std::fill_n(distance_.begin() + reach * kPairBlock, kPairBlock, 0.0f);
      exponentials(distance_.data(), neighbours * kPairBlock);
      factor = distance_.data();
    }
    if (dy == 0)
      std::fill_n(passed_.begin() + reach * kPairBlock, kPairBlock, ~0u);  // the centre itself
    weights_of_row(factor, passed_.data(), rows(count_).q, neighbours, weight_.data());
    return reach;
  }

  void run_block(int x, int y, PairMeans& means) {
    const int r = window_.radius;
    double sum[kPairBlock] = {}, squares[kPairBlock] = {};
    const auto sums = std::make_unique<double[][kPairBlock]>(values_.size());
    for (int dy = -r; dy <= r; ++dy) {
      const int reach = weigh(x, y, dy), neighbours = 2 * reach + 1;
      add_weights(weight_.data(), neighbours, sum, squares);
      for (std::size_t v = 0; v < values_.size(); v += kMostPairValues) {
        const std::size_t count = std::min(kMostPairValues, values_.size() - v);
        const double* from[kMostPairValues];
        for (std::size_t i = 0; i < count; ++i)
          from[i] = &values_[v + i](x + r - reach, y + r + dy);
        add_values(weight_.data(), neighbours, from, count, &sums[v]);
      }
    }
    for (int l = 0; l < kPairBlock && x + l < tile_.width(); ++l) {
      const int to_x = tile_.x0 + x + l, to_y = tile_.y0 + y;
      means.weight(to_x, to_y) = sum[l];
      means.weight2(to_x, to_y) = squares[l];
      for (std::size_t v = 0; v < values_.size(); ++v) {
        means.value[v](to_x, to_y) = sum[l] > 0.0 ? sums[v][l] / sum[l] : 0.0;
      }
    }
  }

  Rectangle tile_;
  PairWindow window_;
  float kappa_;
  std::vector<Image<float>> mean_, half2_, feature_, variance_;  // a radius beyond the tile
  Image<float> count_;
  std::vector<Plane> values_;
  std::vector<RowOfWindow> window_rows_;
  std::vector<float> distance_, weight_;  // [neighbour][piece of the block]
  std::vector<std::uint32_t> passed_;
};

}  // namespace

PairMeans pair_filter(const std::vector<const Plane*>& values, const PairTest& test,
                      const PairFeatures& features, const Image<float>& count,
                      const PairWindow& window) {
  const auto zeros = [&] { return Plane(count.width(), count.height()); };
  PairMeans means{std::vector<Plane>(values.size(), zeros()), zeros(), zeros()};
  parallel_tiles(count.bounds(), kTileWidth, kTileHeight, [&](const Rectangle& tile) {
    TileFilter(values, test, features, count, window, tile).run(means);
  });
  return means;
}

void add_pair_footprint(const RgbImage& values, const PairTest& test, const PairFeatures& features,
                        const Image<float>& count, const PairWindow& window, int x, int y,
                        double share, int q, Footprint& to) {
  const std::vector<TileFilter::Weight> weights =
      TileFilter({}, test, features, count, window, {x, y, x + 1, y + 1}).weights_of_corner();
  double sum = 0.0;
  for (const TileFilter::Weight& neighbour : weights)
    sum += neighbour.weight;
  if (weights.empty()) to.add(x / q, y / q, share, values, values[0].index(x, y));
  for (const auto& [from_x, from_y, weight] : weights)
    to.add(from_x / q, from_y / q, share * weight / sum, values, values[0].index(from_x, from_y));
}

}  // namespace spool
