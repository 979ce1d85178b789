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
constexpr int kLanes = 16;  // pieces whose sums stay in registers while the offsets of a row pass
constexpr double kMostValue = 1e30;  // whose sums are finite in float
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));

// Weights and images of one row as one row of pieces sees them.
struct RowRun {
  const float* weights;  // of the first piece at the first offset
  std::ptrdiff_t step;   // between offsets
  const float* spatial;  // [offset]
  int offsets;
  const float*
      values[3];  // of the first piece at the first offset; an offset further is one further
  int count;      // pieces, rounded up to whole lanes
};

// to[l] += from[l] of kLanes pieces.
inline void add_lanes(const Floats& from, double* to) {
  float values[kLanes];
  std::memcpy(values, &from, sizeof(values));
  for (int l = 0; l < kLanes; ++l)
    to[l] += static_cast<double>(values[l]);
}

// sums[i][x] += sum over offsets of weight * spatial * value, total[x] the same of the weights.
// `sums` are `kImages` rows, `total` may be null.
template <int kImages>
SPOOL_VECTOR_CLONES void add_run(const RowRun& run, double* const* sums, double* total) {
  static_assert(kImages >= 1 && kImages <= 3);
  for (int x = 0; x < run.count; x += kLanes) {
    Floats sum0{}, sum1{}, sum2{}, weights{};
    const float* from0 = run.values[0] + x;
    const float* from1 = run.values[kImages > 1 ? 1 : 0] + x;
    const float* from2 = run.values[kImages > 2 ? 2 : 0] + x;
    for (int j = 0; j < run.offsets; ++j) {
      Floats weight, value;
      std::memcpy(&weight, run.weights + j * run.step + x, sizeof(Floats));
      weight *= run.spatial[j];
      std::memcpy(&value, from0 + j, sizeof(Floats));
      sum0 += weight * value;
      if constexpr (kImages > 1) {
        std::memcpy(&value, from1 + j, sizeof(Floats));
        sum1 += weight * value;
      }
      if constexpr (kImages > 2) {
        std::memcpy(&value, from2 + j, sizeof(Floats));
        sum2 += weight * value;
      }
      weights += weight;
    }
    add_lanes(sum0, sums[0] + x);
    if constexpr (kImages > 1) add_lanes(sum1, sums[1] + x);
    if constexpr (kImages > 2) add_lanes(sum2, sums[2] + x);
    if (total != nullptr) add_lanes(weights, total + x);
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
  Tile(const FeatureGuide& guide, std::span<const GuidedImage> images,
       const std::vector<GuidedTarget>& targets, const std::vector<Kernel>& kernels,
       const Rectangle& tile)
      : guide_(guide),
        images_(images),
        targets_(targets),
        kernels_(kernels),
        tile_(tile),
        radius_(largest(kernels, &Kernel::radius)),
        across_(largest(kernels, &Kernel::across)),
        stride_((kTileWidth + 2 * across_ + kLanes - 1) / kLanes * kLanes),
        pairs_(guide, tile, across_, radius_),
        weights_(std::size_t(2 * across_ + 1) * std::size_t(stride_)) {
    for (const GuidedTarget& target : targets) {
      sums_.push_back({std::vector<Plane>(target.count, Plane(kTileWidth, tile.height())),
                       Plane(kTileWidth, tile.height())});
    }
    copy_values();
  }

  const std::vector<GuidedMeans>& run() {
    // Rows beyond the tile before and after those inside, so that every row of the tile meets its
    // neighbours from the top down.
    for (int y = std::max(0, tile_.y0 - radius_); y < tile_.y0; ++y) {
      for (int inside = tile_.y0; inside <= std::min(y + radius_, tile_.y1 - 1); ++inside) {
        pairs_.weights(inside, y, false, stride_, weights_.data());
        add_row(inside, y, false);
      }
    }
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int below = y; below <= std::min(y + radius_, guide_.height - 1); ++below) {
        const bool both = below > y && below < tile_.y1;
        pairs_.weights(y, below, both, stride_, weights_.data());
        add_row(y, below, false);
        if (both) add_row(below, y, true);
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
  // The part that the tile's windows reach, 0 beyond the image.
  void copy_values() {
    const int x0 = std::max(0, tile_.x0 - across_), x1 = std::min(guide_.width, tile_.x1 + across_);
    const int y0 = std::max(0, tile_.y0 - radius_);
    const int y1 = std::min(guide_.height, tile_.y1 + radius_);
    for (const GuidedImage& image : images_) {
      Image<float>& part =
          values_.emplace_back(static_cast<int>(stride_), tile_.height() + 2 * radius_);
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const double value = image.factor * (*image.plane)(x, y);
          part(x - tile_.x0 + across_, y - tile_.y0 + radius_) =
              static_cast<float>(std::clamp(value, -kMostValue, kMostValue));
        }
      }
    }
  }

  // Adds the pieces of row qy to the sums of row y; `mirrored` if the weights are those of row qy
  // with row y.
  void add_row(int y, int qy, bool mirrored) {
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const Kernel& kernel = kernels_[t];
      if (std::abs(qy - y) > kernel.radius) continue;
      // Mirrored, the weight of offset dx is that of -dx at the neighbour.
      const float* weights = weights_.data() + across_;
      weights += mirrored ? (across_ + kernel.across) * stride_ - kernel.across
                          : (across_ - kernel.across) * stride_;
      double* total = sums_[t].weight.row(y - tile_.y0).data();
      for (std::size_t i = 0; i < targets_[t].count; i += 3) {
        const std::size_t images = std::min<std::size_t>(3, targets_[t].count - i);
        double* sums[3] = {};
        const float* values[3] = {};
        for (std::size_t k = 0; k < images; ++k) {
          sums[k] = sums_[t].values[i + k].row(y - tile_.y0).data();
          values[k] =
              &values_[targets_[t].first + i + k](across_ - kernel.across, qy - tile_.y0 + radius_);
        }
        const RowRun run = {weights,
                            mirrored ? 1 - stride_ : stride_,
                            kernel.row(qy - y),
                            2 * kernel.across + 1,
                            {values[0], values[1], values[2]},
                            (tile_.width() + kLanes - 1) / kLanes * kLanes};
        (images == 1   ? add_run<1>
         : images == 2 ? add_run<2>
                       : add_run<3>)(run, sums, i == 0 ? total : nullptr);
      }
    }
  }

  const FeatureGuide& guide_;
  std::span<const GuidedImage> images_;
  const std::vector<GuidedTarget>& targets_;
  const std::vector<Kernel>& kernels_;
  Rectangle tile_;
  int radius_, across_;    // of the largest kernel
  std::ptrdiff_t stride_;  // of what follows: the tile and what its windows reach
  GuideTile pairs_;
  std::vector<float> weights_;        // [dx][x]
  std::vector<GuidedMeans> sums_;     // [target], kTileWidth wide
  std::vector<Image<float>> values_;  // [image], as wide as weights
};

}  // namespace

void guided_means(
    const FeatureGuide& guide, std::span<const GuidedImage> images,
    const std::vector<GuidedTarget>& targets,
    const std::function<void(const Rectangle&, const std::vector<GuidedMeans>&)>& use) {
  std::vector<Kernel> kernels;
  for (const GuidedTarget& target : targets)
    kernels.emplace_back(target.scale, guide.width);
  const int across = (guide.width + kTileWidth - 1) / kTileWidth;
  const int down = (guide.height + kTileHeight - 1) / kTileHeight;
  parallel_for(static_cast<std::size_t>(across) * static_cast<std::size_t>(down),
               [&](std::size_t i) {
                 const int x0 = static_cast<int>(i) % across * kTileWidth;
                 const int y0 = static_cast<int>(i) / across * kTileHeight;
                 const Rectangle tile = intersect({x0, y0, x0 + kTileWidth, y0 + kTileHeight},
                                                  {0, 0, guide.width, guide.height});
                 Tile sums(guide, images, targets, kernels, tile);
                 use(tile, sums.run());
               });
}

}  // namespace spool
