#include "lib/kernels/guided_means.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/kernels/guide_tile.h"

namespace spool {
namespace {

constexpr int kTileWidth = 128, kTileHeight = 64;
constexpr int kLanes = 4;  // pieces whose sums stay in registers while the offsets of a row pass
typedef double Doubles __attribute__((vector_size(kLanes * sizeof(double))));
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));

// Weights and images of one row as one row of pieces uses them.
struct RowRun {
  const float* weights;  // of the first piece at the first offset
  std::ptrdiff_t step;   // between offsets
  const float* spatial;  // [offset]
  int offsets;
  const double* values;  // of the first piece at the first offset; an offset further is one further
  std::ptrdiff_t value_stride;  // between images
  int count;                    // pieces, rounded up to whole lanes
};

// sums[i][x] += sum over offsets of weight * spatial * value, total[x] the same of the weights.
// `sums` are `kImages` rows, `total` may be null.
template <int kImages>
SPOOL_VECTOR_CLONES void add_run(const RowRun& run, double* const* sums, double* total) {
  static_assert(kImages >= 1 && kImages <= 3);
  for (int x = 0; x < run.count; x += kLanes) {
    Doubles sum0{}, sum1{}, sum2{}, weights{};
    std::memcpy(&sum0, sums[0] + x, sizeof(Doubles));
    if constexpr (kImages > 1) std::memcpy(&sum1, sums[1] + x, sizeof(Doubles));
    if constexpr (kImages > 2) std::memcpy(&sum2, sums[2] + x, sizeof(Doubles));
    if (total != nullptr) std::memcpy(&weights, total + x, sizeof(Doubles));
    const double* values = run.values + x;
    for (int j = 0; j < run.offsets; ++j) {
      Floats narrow;
      std::memcpy(&narrow, run.weights + j * run.step + x, sizeof(Floats));
      narrow *= run.spatial[j];
      const Doubles weight = __builtin_convertvector(narrow, Doubles);
      Doubles value;
      std::memcpy(&value, values + j, sizeof(Doubles));
      sum0 += weight * value;
      if constexpr (kImages > 1) {
        std::memcpy(&value, values + run.value_stride + j, sizeof(Doubles));
        sum1 += weight * value;
      }
      if constexpr (kImages > 2) {
        std::memcpy(&value, values + 2 * run.value_stride + j, sizeof(Doubles));
        sum2 += weight * value;
      }
      weights += weight;
    }
    std::memcpy(sums[0] + x, &sum0, sizeof(Doubles));
    if constexpr (kImages > 1) std::memcpy(sums[1] + x, &sum1, sizeof(Doubles));
    if constexpr (kImages > 2) std::memcpy(sums[2] + x, &sum2, sizeof(Doubles));
    if (total != nullptr) std::memcpy(total + x, &weights, sizeof(Doubles));
  }
}

int radius_of(double scale) {
  return static_cast<int>(std::lround(2.0 * scale));
}

// Of one target: reach and spatial weights [dy][dx], both from -reach.
struct Kernel {
  explicit Kernel(double scale, int width) : radius(radius_of(scale)) {
    across = std::min(radius, width - 1);
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -across; dx <= across; ++dx) {
        spatial.push_back(
            static_cast<float>(std::exp(-(dx * dx + dy * dy) / (2.0 * scale * scale))));
      }
    }
  }
  const float* row(int dy) const {
    return &spatial[std::size_t(dy + radius) * std::size_t(2 * across + 1)];
  }

  int radius, across;  // pieces down, and across, where no neighbour is further than the image
  std::vector<float> spatial;
};

int largest(const std::vector<Kernel>& kernels, int Kernel::* reach) {
  int result = 0;
  for (const Kernel& kernel : kernels)
    result = std::max(result, kernel.*reach);
  return result;
}

// The sums of one tile. A pair of rows of the tile has its weights computed once, for both.
class Tile {
 public:
  Tile(const FeatureGuide& guide, std::span<const Plane* const> images,
       const std::vector<GuidedTarget>& targets, const std::vector<Kernel>& kernels,
       const Rectangle& tile)
      : guide_(guide),
        images_(images),
        targets_(targets),
        kernels_(kernels),
        tile_(tile),
        radius_(largest(kernels, &Kernel::radius)),
        across_(largest(kernels, &Kernel::across)),
        stride_(static_cast<std::size_t>((kTileWidth + 2 * across_ + GuideTile::kLanes - 1) /
                                         GuideTile::kLanes * GuideTile::kLanes)),
        pairs_(guide, tile, across_, radius_),
        weights_(std::size_t(2 * across_ + 1) * stride_),
        near_values_(images.size() * stride_),
        far_values_(images.size() * stride_) {
    for (const GuidedTarget& target : targets) {
      sums_.push_back({std::vector<Plane>(target.count, Plane(kTileWidth, tile.height())),
                       Plane(kTileWidth, tile.height())});
    }
  }

  const std::vector<GuidedMeans>& run() {
    // Rows beyond the tile before and after those inside, so that every row of the tile meets its
    // neighbours from the top down.
    for (int y = std::max(0, tile_.y0 - radius_); y < tile_.y0; ++y) {
      copy_values(y, near_values_);
      for (int inside = tile_.y0; inside <= std::min(y + radius_, tile_.y1 - 1); ++inside) {
        pairs_.weights(inside, y, false, std::ptrdiff_t(stride_), weights_.data());
        add_row(inside, y, near_values_, false);
      }
    }
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      copy_values(y, near_values_);
      for (int below = y; below <= std::min(y + radius_, guide_.height - 1); ++below) {
        const bool both = below > y && below < tile_.y1;
        pairs_.weights(y, below, both, std::ptrdiff_t(stride_), weights_.data());
        copy_values(below, far_values_);
        add_row(y, below, far_values_, false);
        if (both) add_row(below, y, near_values_, true);
      }
    }
    for (GuidedMeans& sums : sums_) {
      for (Plane& values : sums.values) {
        for (int y = 0; y < tile_.height(); ++y) {
          for (int x = 0; x < tile_.width(); ++x)
            values(x, y) /= sums.weight(x, y);
        }
      }
    }
    return sums_;
  }

 private:
  // The row's part that the tile's windows reach, 0 beyond the image.
  void copy_values(int y, std::vector<double>& to) const {
    const int x0 = std::max(0, tile_.x0 - across_);
    const int x1 = std::min(guide_.width, tile_.x1 + across_);
    for (std::size_t i = 0; i < images_.size(); ++i) {
      std::copy_n(&(*images_[i])(x0, y), x1 - x0,
                  &to[i * stride_ + static_cast<std::size_t>(x0 - tile_.x0 + across_)]);
    }
  }

  // Adds the pieces of row qy to the sums of row y; `mirrored` if the weights are those of row qy
  // with row y.
  void add_row(int y, int qy, const std::vector<double>& values, bool mirrored) {
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const Kernel& kernel = kernels_[t];
      if (std::abs(qy - y) > kernel.radius) continue;
      const auto stride = static_cast<std::ptrdiff_t>(stride_);
      // Mirrored, the weight of offset dx is that of -dx at the neighbour.
      const float* weights = weights_.data() + across_;
      weights += mirrored ? (across_ + kernel.across) * stride - kernel.across
                          : (across_ - kernel.across) * stride;
      double* total = sums_[t].weight.row(y - tile_.y0).data();
      for (std::size_t i = 0; i < targets_[t].count; i += 3) {
        const std::size_t images = std::min<std::size_t>(3, targets_[t].count - i);
        double* sums[3] = {};
        for (std::size_t k = 0; k < images; ++k)
          sums[k] = sums_[t].values[i + k].row(y - tile_.y0).data();
        const RowRun run = {weights,
                            mirrored ? 1 - stride : stride,
                            kernel.row(qy - y),
                            2 * kernel.across + 1,
                            &values[(targets_[t].first + i) * stride_ +
                                    static_cast<std::size_t>(across_ - kernel.across)],
                            stride,
                            (tile_.width() + kLanes - 1) / kLanes * kLanes};
        (images == 1   ? add_run<1>
         : images == 2 ? add_run<2>
                       : add_run<3>)(run, sums, i == 0 ? total : nullptr);
      }
    }
  }

  const FeatureGuide& guide_;
  std::span<const Plane* const> images_;
  const std::vector<GuidedTarget>& targets_;
  const std::vector<Kernel>& kernels_;
  Rectangle tile_;
  int radius_, across_;  // of the largest kernel
  std::size_t stride_;   // of what follows: the tile and what its windows reach
  GuideTile pairs_;
  std::vector<float> weights_;                    // [dx][x]
  std::vector<double> near_values_, far_values_;  // [image][x]
  std::vector<GuidedMeans> sums_;                 // [target], kTileWidth wide
};

}  // namespace

void guided_means(
    const FeatureGuide& guide, std::span<const Plane* const> images,
    const std::vector<GuidedTarget>& targets,
    const std::function<void(const Rectangle&, const std::vector<GuidedMeans>&)>& use) {
  std::vector<Kernel> kernels;
  for (const GuidedTarget& target : targets)
    kernels.emplace_back(target.scale, guide.width);
  parallel_tiles({0, 0, guide.width, guide.height}, kTileWidth, kTileHeight,
                 [&](const Rectangle& tile) {
                   Tile sums(guide, images, targets, kernels, tile);
                   use(tile, sums.run());
                 });
}

}  // namespace spool
