#include "lib/sampling/priority_order.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "lib/core/check.h"
#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

// Priorities in their order as whole numbers; all are > 0.
std::uint64_t rank_of(double priority) {
  return std::bit_cast<std::uint64_t>(priority);
}

// About `stride`, at least 1, so that entries of an image that far apart lie neither in a column
// nor on a diagonal: each starts 0.618 of a row further on than the last.
std::size_t scattered_stride(std::size_t stride, int width) {
  const auto row = static_cast<std::size_t>(width);
  if (stride < row / 2) return std::max<std::size_t>(stride, 1);
  return stride / row * row + std::max<std::size_t>(row * 618 / 1000, 1);
}

// How many of `count` priorities are in (lower, upper].
template <class T>
std::size_t between(const T* priority, int count, T lower, T upper) {
  std::int32_t found = 0;
  for (int i = 0; i < count; ++i)
    found += static_cast<std::int32_t>(priority[i] > lower) &
             static_cast<std::int32_t>(priority[i] <= upper);
  return static_cast<std::size_t>(found);
}
SPOOL_VECTOR_CLONES
std::size_t count_between(const float* priority, int count, float lower, float upper) {
  return between(priority, count, lower, upper);
}
SPOOL_VECTOR_CLONES
std::size_t count_between(const double* priority, int count, double lower, double upper) {
  return between(priority, count, lower, upper);
}

}  // namespace

template <class T>
PriorityOrder<T>::PriorityOrder(const PriorityMaxima<T>& maxima, std::size_t expected,
                                IsFree is_free)
    : maxima_(maxima),
      expected_(std::max<std::size_t>(expected, 16)),
      is_free_(std::move(is_free)),
      upper_(std::numeric_limits<double>::infinity()) {
  constexpr std::size_t kSampled = 1 << 12;
  int rows = 0;
  for (const Image<T>& image : maxima.images()) {
    image_begin_.push_back(entries_);
    entries_ += image.size();
    rows = std::max(rows, image.height());
  }
  image_begin_.push_back(entries_);
  SPOOL_CHECK_LE(entries_, std::size_t{1} << 32);  // of whose pieces alone 85 GB are kept
  row_end_.resize(static_cast<std::size_t>(rows + kMaximaSide - 1) / kMaximaSide);
  for (const Image<T>& image : maxima.images()) {
    const std::size_t stride = scattered_stride(entries_ / kSampled, image.width());
    for (std::size_t i = 0; i < image.size(); i += stride) {
      if (image[i] > 0.0) sampled_.push_back(image[i]);
    }
  }
}

template <class T>
RegionEntry PriorityOrder<T>::entry_of(const Candidate& candidate) const {
  std::size_t image = 0;
  while (candidate.place >= image_begin_[image + 1])
    ++image;
  const std::size_t at = candidate.place - image_begin_[image];
  const auto width = static_cast<std::size_t>(maxima_.images()[image].width());
  return {static_cast<int>(image) + maxima_.first_level(), static_cast<int>(at % width),
          static_cast<int>(at / width), candidate.priority};
}

template <class T>
template <class Body>
void PriorityOrder<T>::for_each_run(std::size_t block_row, double lower, const Body& body) const {
  constexpr int side = kMaximaSide;
  const int y0 = static_cast<int>(block_row) * side;
  for (std::size_t image = 0; image < maxima_.images().size(); ++image) {
    const Image<T>& priority = maxima_.images()[image];
    for (int y = y0; y < std::min(y0 + side, priority.height()); ++y) {
      for (int x0 = 0; x0 < priority.width(); x0 += side) {
        if (!(maxima_.of_row(image, y, x0 / side) > lower)) continue;
        const auto run = priority.row(y).subspan(
            static_cast<std::size_t>(x0),
            static_cast<std::size_t>(std::min(side, priority.width() - x0)));
        body(run, image_begin_[image] + priority.index(x0, y));
      }
    }
  }
}

template <class T>
bool PriorityOrder<T>::gather() {
  batch_.clear();
  while (batch_.empty() && upper_ > 0.0) {
    const std::size_t per_sample = std::max<std::size_t>(entries_ / (sampled_.size() + 1), 1);
    const auto used = static_cast<std::ptrdiff_t>(sampled_used_);
    sampled_used_ += std::max<std::size_t>(4 * expected_ / per_sample, 4);
    double lower = 0.0;
    if (sampled_used_ < sampled_.size()) {
      const auto cut = sampled_.begin() + static_cast<std::ptrdiff_t>(sampled_used_);
      std::nth_element(sampled_.begin() + used, cut, sampled_.end(), std::greater<>());
      lower = *cut;
    }
    if (lower >= upper_) continue;  // many equal priorities
    const auto least = static_cast<T>(lower), most = static_cast<T>(upper_);
    parallel_for(row_end_.size(), [&](std::size_t r) {
      std::size_t found = 0;
      for_each_run(r, lower, [&](std::span<const T> run, std::size_t) {
        found += count_between(run.data(), static_cast<int>(run.size()), least, most);
      });
      row_end_[r] = found;
    });
    std::partial_sum(row_end_.begin(), row_end_.end(), row_end_.begin());
    batch_.resize(row_end_.empty() ? 0 : row_end_.back());
    parallel_for(row_end_.size(), [&](std::size_t r) {
      std::size_t at = r == 0 ? 0 : row_end_[r - 1];
      for_each_run(r, lower, [&](std::span<const T> run, std::size_t place) {
        for (std::size_t i = 0; i < run.size(); ++i) {
          if (run[i] > least && run[i] <= most)
            batch_[at++] = {run[i], static_cast<std::uint32_t>(place + i)};
        }
      });
    });
    upper_ = lower;
  }
  lay_out();
  return !batch_.empty();
}

template <class T>
void PriorityOrder<T>::lay_out() {
  constexpr std::uint64_t kBuckets = 1 << 11;
  bucket_ = used_ = bucket_last_ = 0;
  bucket_end_.clear();
  if (batch_.empty()) return;
  const auto [least, most] = std::minmax_element(
      batch_.begin(), batch_.end(),
      [](const Candidate& a, const Candidate& b) { return a.priority < b.priority; });
  const std::uint64_t lowest = rank_of(least->priority), highest = rank_of(most->priority);
  int shift = 0;
  while ((highest - lowest) >> shift >= kBuckets)
    ++shift;
  const auto bucket_of = [&](const Candidate& candidate) {
    return static_cast<std::size_t>((highest - rank_of(candidate.priority)) >> shift);
  };
  std::vector<std::size_t> begin(kBuckets + 1, 0);
  for (const Candidate& candidate : batch_)
    ++begin[bucket_of(candidate) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Candidate> laid(batch_.size());
  for (const Candidate& candidate : batch_)
    laid[begin[bucket_of(candidate)]++] = candidate;
  batch_.swap(laid);
  begin.pop_back();
  bucket_end_ = std::move(begin);  // each begin has moved to the end of its bucket
}

template <class T>
bool PriorityOrder<T>::next_bucket() {
  if (bucket_ == bucket_end_.size()) return false;
  used_ = bucket_ == 0 ? 0 : bucket_end_[bucket_ - 1];
  const auto first = batch_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto end = batch_.begin() + static_cast<std::ptrdiff_t>(bucket_end_[bucket_++]);
  const auto last = std::remove_if(
      first, end, [&](const Candidate& candidate) { return !is_free_(entry_of(candidate)); });
  bucket_last_ = used_ + static_cast<std::size_t>(last - first);
  std::sort(first, last, [](const Candidate& a, const Candidate& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.place < b.place;
  });
  return true;
}

template <class T>
std::optional<RegionEntry> PriorityOrder<T>::next() {
  while (true) {
    while (used_ < bucket_last_) {
      const RegionEntry entry = entry_of(batch_[used_++]);
      if (is_free_(entry)) return entry;
    }
    if (!next_bucket() && !gather()) return std::nullopt;
  }
}

template class PriorityOrder<double>;
template class PriorityOrder<float>;

}  // namespace spool
