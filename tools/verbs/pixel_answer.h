// What a recording holds of one pixel: its samples in the order in which a replay takes them, their
// running mean with its interval, a histogram of their luminance; and what a replay made of it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/footprint.h"
#include "lib/pool/sample_pool.h"

namespace spool::tools {

// Of the positive values on a logarithmic axis; the others are counted apart.
struct LogHistogram {
  std::size_t not_positive = 0;
  std::vector<double> edges;  // one more than there are counts; empty without positive values
  std::vector<int> counts;
};

struct PixelAnswer {
  int x = 0, y = 0;
  int capacity = 0;                           // recorded samples
  std::vector<int> recorded;                  // [sample] its place in the recording
  std::vector<std::array<float, 3>> samples;  // [sample] R, G, B
  std::vector<double> mean, low, high;        // of the luminance of the first 1, 2, ... samples
  LogHistogram histogram;

  std::string sampler, filter;  // empty: none, or known to who asks
  std::optional<int> taken;     // samples that the sampler took
  std::optional<std::array<double, 3>> image;
  std::optional<Footprint> footprint;  // none beside an image: the filter has no weights to give
};

// Of the first `most` samples; 0: all. (x, y) must lie in the pool, whose pieces are pixels.
PixelAnswer pixel_answer(const SamplePool& pool, int x, int y, int most);

}  // namespace spool::tools
