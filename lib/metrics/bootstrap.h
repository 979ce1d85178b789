// Standard errors of image statistics by resampling 16x16 pixel blocks with replacement
// [EfronTibshirani93, 8.6].
//
// Neighbouring pixels share filter windows, so single pixels are not independent; blocks nearly
// are. A resample draws as many blocks as the image has; a statistic is evaluated once per resample
// from the number of times each block was drawn. Draws come from the counter-based generator and
// depend on seed, image size and block size only, so two images of the same size are resampled
// alike and their differences may be taken resample by resample.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "lib/core/rectangle.h"

namespace spool {

struct BootstrapOptions {
  int block_size = 16;  // pixels
  int resamples = 200;
  std::uint64_t seed = 1;
};

class BlockBootstrap {
 public:
  BlockBootstrap(int width, int height, const BootstrapOptions& options = {});

  int blocks() const { return blocks_x_ * blocks_y_; }
  int resamples() const { return resamples_; }
  int block_of(int x, int y) const { return y / block_size_ * blocks_x_ + x / block_size_; }
  Rectangle block_bounds(int block) const;  // cropped at the right and bottom
  // Times that each block was drawn, [block].
  std::span<const double> weights(int resample) const;

 private:
  int width_, height_, block_size_, blocks_x_, blocks_y_, resamples_;
  std::vector<double> weights_;  // [resample][block]
};

// Sum of weights[b] * values[b] in index order; `weights` empty: the plain pairwise sum.
double weighted_sum(std::span<const double> values, std::span<const double> weights);

// That of every resample; the same bits.
std::vector<double> resampled_sums(std::span<const double> values, const BlockBootstrap& bootstrap);

// Standard deviation of the values a statistic took over the resamples; resamples where it is not
// finite are left out. NaN when fewer than two remain.
double standard_error_of(std::span<const double> resampled);

// n / d, without a floating-point exception where nothing is divided by nothing: NaN there,
// infinite where something is.
double quotient(double n, double d);

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};
// Whether two blocks at least have something of what is averaged over, [block]: resamples of one
// are all alike, which is no standard error of 0.
bool in_several_blocks(std::span<const double> denominator);

// sum(numerator) / sum(denominator) over blocks with its bootstrap standard error. The standard
// error is NaN where not in_several_blocks(denominator). `numerator` and `denominator`: [block].
Estimate ratio_of_sums(const BlockBootstrap& bootstrap, std::span<const double> numerator,
                       std::span<const double> denominator);

}  // namespace spool
