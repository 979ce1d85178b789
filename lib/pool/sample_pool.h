// A replayable view of a recording: for every piece of the image an ordered list of samples.
//
// Pieces are the cells of a grid with q x q equal squares per pixel (q = 1: a piece is a pixel). A
// sampler owns a cursor per piece and always takes the sample at its cursor next; samples behind
// the cursor are all it may know. Samples held out for judging are at the end of each list and are
// never offered. Immutable; any number of threads may read.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/core/random.h"
#include "lib/pool/recorded_samples.h"

namespace spool {

enum class PoolOrder { kRecorded, kShuffled };

struct PoolOptions {
  int pieces_per_side = 1;                 // q, 1 or 2; 2 needs film positions
  PoolOrder order = PoolOrder::kRecorded;  // kShuffled: every pixel by its own permutation
  std::uint64_t seed = 0;                  // of the permutations; one per replicate
  int holdout = 0;                         // samples per pixel kept for the reference, at the end
  // Where each list begins, as a share of it; what lies before comes after its end. 0 <= start < 1.
  double start = 0;
};

// `value` scaled down to luminance `limit` where it exceeds it, all channels alike.
inline Rgb limited(Rgb value, double limit) {
  const double y = luminance(value[0], value[1], value[2]);
  if (y > limit) {
    for (float& v : value)
      v = static_cast<float>(v * (limit / y));
  }
  return value;
}

class SamplePool {
 public:
  // Errors: kData when q = 2 without film positions or when the holdout leaves no sample.
  static Result<SamplePool> create(std::shared_ptr<const RecordedSamples> recording,
                                   const PoolOptions& options);

  const RecordedSamples& recording() const { return *recording_; }
  const PoolOptions& options() const { return options_; }
  int pieces_per_side() const { return options_.pieces_per_side; }
  int width() const { return recording_->width() * options_.pieces_per_side; }    // pieces
  int height() const { return recording_->height() * options_.pieces_per_side; }  // pieces

  // Samples that a sampler may take from piece (x, y).
  int capacity(int x, int y) const;
  long long total_capacity() const;

  // The i-th sample of the piece, 0 <= i < size(x, y): i < capacity() for samplers, the rest is
  // held out.
  Rgb sample(int x, int y, int i) const {
    const int q = options_.pieces_per_side;
    const Rgb value = recording_->radiance(x / q, y / q, recorded_index(x, y, i));
    return limits_ ? limited(value, (*limits_)(x / q, y / q)) : value;
  }
  FilmPosition film(int x, int y, int i) const {
    const int q = options_.pieces_per_side;
    return recording_->film(x / q, y / q, recorded_index(x, y, i));
  }
  // The pool of every second sample of each piece: 0 the even ones, 1 the odd ones. Disjoint
  // halves, for methods that filter both and compare. Its sample i is sample 2 i + parity of this
  // pool.
  SamplePool half(int parity) const;
  bool is_half() const { return stride_ > 1 || (halves_first_ && halves_first_->stride > 1); }
  // Pieces are pixels, and sample i of each is the i-th recorded one as it lies in the file.
  bool as_recorded() const;
  // The same samples of each piece in another order: first the even[y][x] first samples of half(0)
  // and the odd[y][x] first ones of half(1), in turn as long as both last; then the others. What is
  // taken of both halves is a prefix of this pool. Counts are at most the capacities of the halves.
  SamplePool with_halves_first(CountImage even, CountImage odd) const;

  // The same pool with every sample whose luminance exceeds that of its pixel in `limits` [y][x]
  // pixels, >= 0, scaled down to it: for methods that clamp (lib/kernels/sample_clamp.h). Of two
  // limits the lower one holds.
  SamplePool with_limits(Plane limits) const;
  SamplePool without_limits() const;

  // Index in the recording of the i-th sample of the piece.
  int recorded_index(int x, int y, int i) const;
  // All samples of the piece, the held-out ones included.
  int size(int x, int y) const;

 private:
  // An order of halves as above, over samples stride i + offset of the whole pool.
  struct HalvesFirst {
    CountImage even, odd;
    int stride = 1, offset = 0;
    int index(std::size_t piece, int i) const;
  };

  int count(int of_whole) const;  // of that many samples of the whole pool, those that are here
  int whole_size(int x, int y) const;
  int whole_capacity(int x, int y) const;

  std::shared_ptr<const RecordedSamples> recording_;
  PoolOptions options_;
  std::shared_ptr<const Plane> limits_;  // luminance of a sample, per pixel; may be null
  // Sample i is sample stride_ i + offset_ of the whole pool, or of the order of halves.
  int stride_ = 1, offset_ = 0;
  std::shared_ptr<const HalvesFirst> halves_first_;  // may be null
  // Recorded indices of each piece's samples, only where that is not simply 0 .. spp-1 (q = 2, or
  // rejected samples): lists_[list_begin_[p] .. list_begin_[p + 1]) for piece p.
  std::vector<std::uint16_t> lists_;
  std::vector<std::size_t> list_begin_;
};

}  // namespace spool
