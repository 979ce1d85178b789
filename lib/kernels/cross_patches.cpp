#include "lib/kernels/cross_patches.h"

#include <algorithm>
#include <array>

#include "lib/core/exponential.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

// Sums of one row of pieces at one sigma.
struct RowSums {
  explicit RowSums(std::size_t width) : weight(width) {
    for (std::size_t c = 0; c < 3; ++c)
      y[c] = y2[c] = turned[c] = turned_y[c] = weight;
  }
  std::vector<double> weight;                // of w
  std::array<std::vector<double>, 3> y, y2;  // of w y, w y^2 of the neighbours
  // of w (y_p - y_2p-q) and of the same times y_q, over neighbours q in the patch
  std::array<std::vector<double>, 3> turned, turned_y;
};

SPOOL_VECTOR_CLONES
void add_square_differences(const double* a, const double* b, int count, float* __restrict to) {
  for (int x = 0; x < count; ++x) {
    const double d = a[x] - b[x];
    to[x] += static_cast<float>(d * d);
  }
}

SPOOL_VECTOR_CLONES
void weights_of_distances(const float* distance, const float* features, float factor, int count,
                          float* __restrict to) {
  for (int x = 0; x < count; ++x)
    to[x] = features[x] * exp_negative(factor * distance[x]);
}

// The same with a factor of each piece.
SPOOL_VECTOR_CLONES
void weights_of_distances(const float* distance, const float* features, const float* factor,
                          int count, float* __restrict to) {
  for (int x = 0; x < count; ++x)
    to[x] = features[x] * exp_negative(factor[x] * distance[x]);
}

SPOOL_VECTOR_CLONES
void add_weights(const float* weight, int count, double* __restrict sum) {
  for (int x = 0; x < count; ++x)
    sum[x] += static_cast<double>(weight[x]);
}

SPOOL_VECTOR_CLONES
void add_channel(const float* weight, const double* y, int count, double* __restrict sum) {
  for (int x = 0; x < count; ++x)
    sum[x] += static_cast<double>(weight[x]) * y[x];
}

SPOOL_VECTOR_CLONES
void add_channel_and_squares(const float* weight, const double* y, int count,
                             double* __restrict sum, double* __restrict squares) {
  for (int x = 0; x < count; ++x) {
    const double wy = static_cast<double>(weight[x]) * y[x];
    sum[x] += wy;
    squares[x] += wy * y[x];
  }
}

// Pieces x0 .. x0 + count - 1 of a row, which have their neighbours at (dx, dy) inside the image.
struct Run {
  int row, dy, dx, x0, count;
};

// Distances of one row's pieces to their neighbours at one offset after the other.
class RowDistances {
 public:
  RowDistances(const FeatureGuide& guide, const RgbImage& y, const CrossPatchOptions& options)
      : guide_(guide), y_(y), options_(options) {
    const auto width = static_cast<std::size_t>(guide.width);
    columns_.resize(width + static_cast<std::size_t>(2 * options.patch));
    distance.resize(width);
    features.resize(width);
  }

  std::vector<float> distance, features;  // D and the feature weight, [x - x0]

  // Calls `use` with every offset of the window, row by row.
  template <class Use>
  void for_each_offset(int row, const Use& use) {
    const int r = options_.window, across = std::min(r, guide_.width - 1);
    for (int qy = std::max(0, row - r); qy <= std::min(guide_.height - 1, row + r); ++qy) {
      for (int dx = -across; dx <= across; ++dx) {
        const int x0 = std::max(0, -dx), x1 = std::min(guide_.width, guide_.width - dx);
        const Run run = {row, qy - row, dx, x0, x1 - x0};
        patch_distances(run);
        feature_weights(guide_, row, qy, dx, x0, x1, features.data());
        use(run);
      }
    }
  }

 private:
  void patch_distances(const Run& run) {
    const int f = options_.patch, height = guide_.height;
    std::fill(columns_.begin(), columns_.end(), 0.0f);  // 0 beyond the image, f on both sides
    for (int b = -f; b <= f; ++b) {
      const int py = run.row + b, qy = py + run.dy;
      if (py < 0 || qy < 0 || py >= height || qy >= height) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        add_square_differences(&y_[c](run.x0, py), &y_[c](run.x0 + run.dx, qy), run.count,
                               columns_.data() + f);
      }
    }
    const float share = 1.0f / static_cast<float>(3 * (2 * f + 1) * (2 * f + 1));
    for (int x = 0; x < run.count; ++x) {
      float sum = columns_[static_cast<std::size_t>(x)];
      for (int b = 1; b <= 2 * f; ++b)
        sum += columns_[static_cast<std::size_t>(x + b)];
      distance[static_cast<std::size_t>(x)] = sum * share;
    }
  }

  const FeatureGuide& guide_;
  const RgbImage& y_;
  const CrossPatchOptions& options_;
  std::vector<float> columns_;
};

// Neighbours in the patch: with p moves the piece that is to p as p is to the neighbour.
void add_turned(const RgbImage& y, const CrossPatchOptions& options, const Run& run,
                const std::vector<float>& weights, RowSums& to) {
  const int f = options.patch, ty = run.row - run.dy, width = y[0].width();
  if (std::abs(run.dy) > f || std::abs(run.dx) > f || ty < 0 || ty >= y[0].height()) return;
  for (int x = std::max(run.x0, run.dx); x < std::min(run.x0 + run.count, width + run.dx); ++x) {
    const double w = static_cast<double>(weights[static_cast<std::size_t>(x - run.x0)]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double moved = w * (y[c](x, run.row) - y[c](x - run.dx, ty));
      to.turned[c][static_cast<std::size_t>(x)] += moved;
      to.turned_y[c][static_cast<std::size_t>(x)] += moved * y[c](x + run.dx, run.row + run.dy);
    }
  }
}

// The sums of a row, [sigma].
std::vector<RowSums> sums_of_row(const FeatureGuide& guide, const RgbImage& y,
                                 const CrossPatchOptions& options, int row) {
  const auto width = static_cast<std::size_t>(guide.width);
  std::vector<RowSums> sums(options.sigmas.size(), RowSums(width));
  std::vector<float> weights(width);
  RowDistances pairs(guide, y, options);
  pairs.for_each_offset(row, [&](const Run& run) {
    const auto x0 = static_cast<std::size_t>(run.x0);
    for (std::size_t s = 0; s < sums.size(); ++s) {
      const double sigma = options.sigmas[s];
      weights_of_distances(pairs.distance.data(), pairs.features.data(),
                           static_cast<float>(0.5 / (sigma * sigma)), run.count, weights.data());
      add_weights(weights.data(), run.count, &sums[s].weight[x0]);
      for (std::size_t c = 0; c < 3; ++c) {
        add_channel_and_squares(weights.data(), &y[c](run.x0 + run.dx, row + run.dy), run.count,
                                &sums[s].y[c][x0], &sums[s].y2[c][x0]);
      }
      add_turned(y, options, run, weights, sums[s]);
    }
  });
  return sums;
}

// One piece of one channel: (F - y)^2 + 2 v dF/dy - v.
double risk_of_channel(const RowSums& sums, std::size_t c, std::size_t x, double y, double v,
                       double curvature) {
  const double weight = sums.weight[x], f = sums.y[c][x] / weight;
  const double spread = sums.y2[c][x] / weight - f * f;
  const double turned = (f * sums.turned[c][x] - sums.turned_y[c][x]) / weight;
  const double slope = 1.0 / weight + curvature * (spread + turned);
  return (f - y) * (f - y) + 2.0 * v * slope - v;
}

}  // namespace

std::vector<Plane> cross_patch_risks(const FeatureGuide& guide, const RgbImage& y,
                                     const RgbImage& v, const CrossPatchOptions& options) {
  std::vector<Plane> risks(options.sigmas.size(), Plane(guide.width, guide.height));
  const double side = 2 * options.patch + 1;
  parallel_rows(0, guide.height, [&](int row) {
    const std::vector<RowSums> sums = sums_of_row(guide, y, options, row);
    for (std::size_t s = 0; s < risks.size(); ++s) {
      const double curvature = 1.0 / (3.0 * options.sigmas[s] * options.sigmas[s] * side * side);
      for (int x = 0; x < guide.width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          risks[s](x, row) += risk_of_channel(sums[s], c, static_cast<std::size_t>(x), y[c](x, row),
                                              v[c](x, row), curvature) /
                              3.0;
        }
      }
    }
  });
  return risks;
}

RgbImage cross_patch_means(const FeatureGuide& guide, const RgbImage& y, const RgbImage& image,
                           const CountImage& choice, const CrossPatchOptions& options) {
  RgbImage result = image;
  parallel_rows(0, guide.height, [&](int row) {
    const auto width = static_cast<std::size_t>(guide.width);
    std::vector<float> factors(width, 0.0f), weights(width);
    for (int x = 0; x < guide.width; ++x) {
      if (choice(x, row) == 0) continue;
      const double sigma = options.sigmas[static_cast<std::size_t>(choice(x, row) - 1)];
      factors[static_cast<std::size_t>(x)] = static_cast<float>(0.5 / (sigma * sigma));
    }
    std::vector<double> total(width);
    std::array<std::vector<double>, 3> sums = {total, total, total};
    RowDistances pairs(guide, y, options);
    pairs.for_each_offset(row, [&](const Run& run) {
      const auto x0 = static_cast<std::size_t>(run.x0);
      weights_of_distances(pairs.distance.data(), pairs.features.data(), &factors[x0], run.count,
                           weights.data());
      add_weights(weights.data(), run.count, &total[x0]);
      for (std::size_t c = 0; c < 3; ++c)
        add_channel(weights.data(), &image[c](run.x0 + run.dx, row + run.dy), run.count,
                    &sums[c][x0]);
    });
    for (int x = 0; x < guide.width; ++x) {
      for (std::size_t c = 0; c < 3 && choice(x, row) > 0; ++c)
        result[c](x, row) =
            sums[c][static_cast<std::size_t>(x)] / total[static_cast<std::size_t>(x)];
    }
  });
  return result;
}

}  // namespace spool
