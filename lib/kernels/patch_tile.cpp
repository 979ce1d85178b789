#include "lib/kernels/patch_tile.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "lib/core/extend.h"
#include "lib/core/vector_clones.h"
#include "lib/kernels/patch_rows.h"

namespace spool {
namespace {

constexpr double kMostMean = 1e15, kMostVariance = 1e10;  // the latter times kappa^2

// to += from, and from = 0.
SPOOL_VECTOR_CLONES
void move_sums(float* __restrict from, std::size_t count, double* __restrict to) {
  for (std::size_t i = 0; i < count; ++i) {
    to[i] += static_cast<double>(from[i]);
    from[i] = 0.0f;
  }
}

// A weighted sum: of one row of offsets in float, of all rows in double. Of targets it is of what
// they differ from the piece's own, so that alike pieces stay what they are to the last bit of a
// double, and the result lies between what it is made of.
struct Sum {
  Image<float> row;
  Plane all;
  void finish_row() { move_sums(row.pixels().data(), row.size(), all.pixels().data()); }
};

// `factor` times the part of an image around a tile, mirrored where it leaves the image, at most
// `most` and at least -most; rows are whole lanes long, zero beyond the part.
Image<float> around(const Plane& image, const Rectangle& tile, int border, double factor,
                    double most) {
  const int width = tile.width() + 2 * border;
  // The last offset reads whole lanes from there on.
  Image<float> result(whole_patch_lanes(width + kPatchLanes), tile.height() + 2 * border);
  const int x0 = tile.x0 - border;
  for (int y = 0; y < result.height(); ++y) {
    const double* from = image.row(extend_symmetric(y + tile.y0 - border, image.height())).data();
    float* to = result.row(y).data();
    const auto copy = [&](int x, int source) {
      to[x] = static_cast<float>(std::clamp(factor * from[source], -most, most));
    };
    const int inside0 = std::clamp(-x0, 0, width);
    const int inside1 = std::clamp(image.width() - x0, inside0, width);
    for (int x = 0; x < inside0; ++x)
      copy(x, extend_symmetric(x0 + x, image.width()));
    for (int x = inside0; x < inside1; ++x)
      copy(x, x0 + x);
    for (int x = inside1; x < width; ++x)
      copy(x, extend_symmetric(x0 + x, image.width()));
  }
  return result;
}

// One tile of the result; every piece's sum runs over the offsets in the same order.
class Tile {
 public:
  Tile(const GuidedTargets& guided, const PatchFilterOptions& options, const Rectangle& tile)
      : guided_(guided),
        options_(options),
        tile_(tile),
        width_(tile.width()),
        height_(tile.height()),
        side_(2 * options.patch + 1),
        noise_(static_cast<float>(options.alpha / (options.kappa * options.kappa))),
        distances_(rings(whole_patch_lanes(width_ + 2 * options.patch))),
        weights_(rings(whole_patch_lanes(width_))) {
    const HalfImage& guide = *guided.guide;
    const int border = options.window + 2 * options.patch;
    for (std::size_t c = 0; c < 3; ++c) {
      a_[c] = around(guide.mean[c], tile, border, 1.0, kMostMean);
      v_[c] = around(guide.variance[c], tile, border, options.kappa * options.kappa, kMostVariance);
    }
    for (const Plane* target : guided.targets) {
      from_.push_back(around(*target, tile, options.window, 1.0, kMostMean));
      sums_.push_back(empty_sum(0.0));
    }
    total_ = empty_sum(1.0);
    const int longest = whole_patch_lanes(whole_patch_lanes(width_ + 4 * options.patch) + side_);
    rows_.resize((kOffsetsTogether + 1) * static_cast<std::size_t>(longest) + kPatchLanes);
    row_ = aligned(rows_);
    for (std::size_t i = 0; i < kOffsetsTogether; ++i)
      boxes_[i] = row_ + (i + 1) * static_cast<std::size_t>(longest);
  }

  std::vector<Plane> run() {
    const int r = options_.window;
    for (int dy = -r; dy <= r; ++dy) {
      std::vector<int> shifts;
      for (int dx = -r; dx <= r; ++dx) {
        if (dx != 0 || dy != 0) shifts.push_back(dx);
      }
      const std::span<const int> all(shifts);
      for (std::size_t i = 0; i < all.size(); i += kOffsetsTogether)
        add_offsets(all.subspan(i, std::min(kOffsetsTogether, all.size() - i)), dy);
      total_.finish_row();
      for (Sum& sum : sums_)
        sum.finish_row();
    }
    std::vector<Plane> means;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const Plane& target = *guided_.targets[i];
      Plane& mean = means.emplace_back(width_, height_);
      for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
          mean(x, y) = target(tile_.x0 + x, tile_.y0 + y) + sums_[i].all(x, y) / total_.all(x, y);
        }
      }
    }
    return means;
  }

 private:
  std::vector<RowRing> rings(int width) const {
    std::vector<RowRing> result;
    for (std::size_t i = 0; i < kOffsetsTogether; ++i)
      result.emplace_back(side_, width);
    return result;
  }

  Sum empty_sum(double of_centre) const {
    const int width = whole_patch_lanes(width_);
    return {Image<float>(width, height_), Plane(width, height_, of_centre)};
  }

  // Rows of the guide that p and q of the given offset read for row y of d2.
  GuideRow guide_row(int y, int dx, int dy) const {
    GuideRow row;
    const int r = options_.window;
    for (std::size_t c = 0; c < 3; ++c) {
      row.a[c] = &a_[c](r + dx, y + r + dy);
      row.v[c] = &v_[c](r + dx, y + r + dy);
    }
    return row;
  }

  // Row by row, and there offset by offset: distances, their boxes, weights, their boxes.
  void add_offsets(std::span<const int> shifts, int dy) {
    const int f = options_.patch;
    const float scale = 1.0f / static_cast<float>(side_ * side_);
    for (int y = 0; y < height_ + 4 * f; ++y) {
      for (std::size_t i = 0; i < shifts.size(); ++i) {
        distance_row(guide_row(y, 0, 0), guide_row(y, shifts[i], dy), noise_,
                     whole_patch_lanes(width_ + 4 * f), row_);
        box_row(row_, distances_[i].next(), side_, scale / 3.0f, whole_patch_lanes(width_ + 2 * f),
                boxes_[i]);
        if (y < 2 * f) continue;
        weights_of_distances(boxes_[i], whole_patch_lanes(width_ + 2 * f));
        std::swap(row_, boxes_[i]);
        box_row(row_, weights_[i].next(), side_, scale, whole_patch_lanes(width_), boxes_[i]);
      }
      if (y >= 4 * f) add_row(y - 4 * f, shifts, dy);
    }
  }

  // boxes_ holds the weights of row y with the rows of the offsets.
  void add_row(int y, std::span<const int> shifts, int dy) {
    const int r = options_.window;
    AddedRows rows{};
    std::copy_n(boxes_.begin(), kOffsetsTogether, rows.weights);
    for (std::size_t t = 0; t < sums_.size(); ++t) {
      for (std::size_t i = 0; i < shifts.size(); ++i)
        rows.from[t][i] = &from_[t](r + shifts[i], y + r + dy);
      rows.own[t] = &from_[t](r, y + r);
      rows.sums[t] = sums_[t].row.row(y).data();
    }
    rows.total = total_.row.row(y).data();
    add_targets(rows, shifts.size(), static_cast<int>(sums_.size()), whole_patch_lanes(width_));
  }

  const GuidedTargets& guided_;
  const PatchFilterOptions& options_;
  Rectangle tile_;
  int width_, height_, side_;
  float noise_;                               // alpha / kappa^2
  std::array<Image<float>, 3> a_, v_;         // of the guide, 2 patch + window beyond the tile
  std::vector<Image<float>> from_;            // targets, window beyond the tile
  std::vector<Sum> sums_;                     // of the tile
  Sum total_;                                 // of the weights, the centre's is 1
  std::vector<RowRing> distances_, weights_;  // sums along rows, of each offset
  std::vector<float> rows_;                   // row_ and boxes_
  float* row_ = nullptr;
  std::array<float*, kOffsetsTogether> boxes_{};
};

}  // namespace

std::vector<Plane> filter_tile(const GuidedTargets& guided, const PatchFilterOptions& options,
                               const Rectangle& tile) {
  SPOOL_CHECK_LE(guided.targets.size(), kMostTargets);
  return Tile(guided, options, tile).run();
}

}  // namespace spool
