#include "lib/pool/sample_pool.h"

#include <algorithm>
#include <utility>

namespace spool {
namespace {

// Piece (0 .. q*q-1, row-major inside the pixel) that a film position falls into.
int piece_of(const FilmPosition& film, int q) {
  const int ix = std::clamp(static_cast<int>(film.x * static_cast<float>(q)), 0, q - 1);
  const int iy = std::clamp(static_cast<int>(film.y * static_cast<float>(q)), 0, q - 1);
  return iy * q + ix;
}

// How many of the first `of` whole numbers are stride i + offset, i >= 0.
int every(int stride, int offset, int of) {
  return std::max(0, (of - offset + stride - 1) / stride);
}

}  // namespace

Result<SamplePool> SamplePool::create(std::shared_ptr<const RecordedSamples> recording,
                                      const PoolOptions& options) {
  SPOOL_CHECK(recording != nullptr);
  SPOOL_CHECK_GE(options.holdout, 0);
  SPOOL_CHECK(options.start >= 0.0 && options.start < 1.0);
  const int q = options.pieces_per_side;
  if (q != 1 && q != 2) {
    return fail(ErrorCode::kUsage, "pieces per pixel side: {} is not 1 or 2", q);
  }
  if (q > 1 && !recording->has_film()) {
    return fail(ErrorCode::kData,
                "{}: quarter-pixel pieces need film positions, which were not recorded: "
                "take whole pixels (--pieces 1, pieces_per_side = 1 in a plan), or record again in "
                "shift mode",
                recording->name());
  }
  if (options.holdout >= recording->spp()) {
    return fail(ErrorCode::kData, "{}: holding out {} of {} samples leaves none to replay",
                recording->name(), options.holdout, recording->spp());
  }
  SamplePool pool;
  pool.recording_ = std::move(recording);
  pool.options_ = options;
  const RecordedSamples& samples = *pool.recording_;
  if (q == 1 && !samples.any_rejected()) return pool;

  pool.list_begin_.assign(static_cast<std::size_t>(pool.width()) * pool.height() + 1, 0);
  for (int y = 0; y < samples.height(); ++y) {
    std::vector<std::vector<std::uint16_t>> pieces(static_cast<std::size_t>(q) * pool.width());
    for (int x = 0; x < samples.width(); ++x) {
      for (int s = 0; s < samples.spp(); ++s) {
        if (samples.rejected(x, y, s)) continue;
        const int piece = q == 1 ? 0 : piece_of(samples.film(x, y, s), q);
        const std::size_t column = static_cast<std::size_t>(x) * q + piece % q;
        pieces[static_cast<std::size_t>(piece / q) * pool.width() + column].push_back(
            static_cast<std::uint16_t>(s));
      }
    }
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      const std::size_t index = static_cast<std::size_t>(y) * q * pool.width() + p;
      pool.lists_.insert(pool.lists_.end(), pieces[p].begin(), pieces[p].end());
      pool.list_begin_[index + 1] = pool.lists_.size();
    }
  }
  // Each piece gives up its share rounded up, and rejected samples are no longer there.
  if (options.holdout > 0 && pool.total_capacity() == 0) {
    return fail(ErrorCode::kData,
                "{}: holding out {} of {} samples leaves none to replay in any of the pixels' {} "
                "pieces: hold out fewer{}",
                samples.name(), options.holdout, samples.spp(), q * q,
                q > 1 ? ", or take whole pixels (--pieces 1, pieces_per_side = 1 in a plan)" : "");
  }
  return pool;
}

SamplePool SamplePool::half(int parity) const {
  SPOOL_CHECK(parity == 0 || parity == 1);
  SamplePool pool = *this;
  pool.stride_ = 2 * stride_;
  pool.offset_ = offset_ + parity * stride_;
  return pool;
}

bool SamplePool::as_recorded() const {
  return options_.order == PoolOrder::kRecorded && options_.start == 0.0 &&
         options_.pieces_per_side == 1 && list_begin_.empty() && !is_half() && !halves_first_ &&
         !limits_ && recording_->as_it_lies();
}

SamplePool SamplePool::with_limits(Plane limits) const {
  SPOOL_CHECK_EQ(limits.width(), recording_->width());
  SPOOL_CHECK_EQ(limits.height(), recording_->height());
  for (std::size_t i = 0; limits_ && i < limits.size(); ++i)
    limits[i] = std::min(limits[i], (*limits_)[i]);
  SamplePool pool = *this;
  pool.limits_ = std::make_shared<const Plane>(std::move(limits));
  return pool;
}

SamplePool SamplePool::without_limits() const {
  SamplePool pool = *this;
  pool.limits_ = nullptr;
  return pool;
}

SamplePool SamplePool::with_halves_first(CountImage even, CountImage odd) const {
  SPOOL_CHECK(halves_first_ == nullptr);
  SPOOL_CHECK(even.width() == width() && even.height() == height() && odd.same_size(even));
  SamplePool pool = *this;
  pool.stride_ = 1;
  pool.offset_ = 0;
  pool.halves_first_ =
      std::make_shared<const HalvesFirst>(std::move(even), std::move(odd), stride_, offset_);
  return pool;
}

int SamplePool::HalvesFirst::index(std::size_t piece, int i) const {
  const int n[2] = {even[piece], odd[piece]};
  const int longer = n[0] > n[1] ? 0 : 1;
  const int both = n[1 - longer], all = n[longer];
  if (i < 2 * both || i >= 2 * all) return stride * i + offset;
  const int beyond = i - 2 * both;  // first what the longer half has more, then its gaps
  const int j = beyond < all - both ? 2 * (both + beyond) + longer
                                    : 2 * (both + beyond - (all - both)) + 1 - longer;
  return stride * j + offset;
}

int SamplePool::count(int of_whole) const {
  if (halves_first_) of_whole = every(halves_first_->stride, halves_first_->offset, of_whole);
  return every(stride_, offset_, of_whole);
}

int SamplePool::size(int x, int y) const {
  return count(whole_size(x, y));
}

int SamplePool::capacity(int x, int y) const {
  return count(whole_capacity(x, y));
}

int SamplePool::whole_size(int x, int y) const {
  if (list_begin_.empty()) return recording_->spp();
  const std::size_t p = static_cast<std::size_t>(y) * width() + x;
  return static_cast<int>(list_begin_[p + 1] - list_begin_[p]);
}

int SamplePool::whole_capacity(int x, int y) const {
  const int all = whole_size(x, y);
  if (options_.holdout == 0) return all;
  // With q = 2 each piece gives up its share of the pixel's held-out samples, rounded up.
  const int pieces = options_.pieces_per_side * options_.pieces_per_side;
  return std::max(0, all - (options_.holdout + pieces - 1) / pieces);
}

long long SamplePool::total_capacity() const {
  long long total = 0;
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x)
      total += capacity(x, y);
  }
  return total;
}

int SamplePool::recorded_index(int x, int y, int i) const {
  const std::size_t p = static_cast<std::size_t>(y) * width() + x;
  int j = stride_ * i + offset_;
  if (halves_first_) j = halves_first_->index(p, j);
  if (options_.start > 0.0) {
    const int all = whole_size(x, y);
    j += static_cast<int>(options_.start * all);
    if (j >= all) j -= all;
  }
  if (options_.order == PoolOrder::kShuffled) {
    j = static_cast<int>(permute_index(static_cast<std::uint32_t>(j),
                                       static_cast<std::uint32_t>(whole_size(x, y)),
                                       mix(options_.seed, p)));
  }
  return list_begin_.empty() ? j : lists_[list_begin_[p] + static_cast<std::size_t>(j)];
}

}  // namespace spool
