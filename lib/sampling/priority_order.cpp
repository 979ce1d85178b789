#include "lib/sampling/priority_order.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <utility>

#include "lib/core/parallel.h"

namespace spool {
namespace {

// Image, then y, then x, of 16, 24 and 24 bits.
std::uint64_t place_of(std::size_t image, int x, int y) {
  return static_cast<std::uint64_t>(image) << 48 | static_cast<std::uint64_t>(y) << 24 |
         static_cast<std::uint64_t>(x);
}

// Priorities in their order as whole numbers; all are > 0.
std::uint64_t rank_of(double priority) {
  return std::bit_cast<std::uint64_t>(priority);
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
    entries_ += image.size();
    rows = std::max(rows, image.height());
  }
  of_row_.resize(static_cast<std::size_t>(rows + kMaximaSide - 1) / kMaximaSide);
  const std::size_t stride = (entries_ / kSampled) | 1;
  for (const Image<T>& image : maxima.images()) {
    for (std::size_t i = 0; i < image.size(); i += stride) {
      if (image[i] > 0.0) sampled_.push_back(image[i]);
    }
  }
  std::sort(sampled_.begin(), sampled_.end(), std::greater<>());
}

template <class T>
RegionEntry PriorityOrder<T>::entry_of(const Candidate& candidate) const {
  constexpr std::uint64_t kMask = (1u << 24) - 1;
  return {static_cast<int>(candidate.place >> 48) + maxima_.first_level(),
          static_cast<int>(candidate.place & kMask),
          static_cast<int>(candidate.place >> 24 & kMask), candidate.priority};
}

// Entries of one row of blocks with lower < priority <= upper_.
template <class T>
void PriorityOrder<T>::gather_rows(int block_row, double lower,
                                   std::vector<Candidate>& found) const {
  constexpr int side = kMaximaSide;
  for (std::size_t image = 0; image < maxima_.images().size(); ++image) {
    const Image<T>& priority = maxima_.images()[image];
    const Rectangle rows = intersect(
        {0, block_row * side, priority.width(), (block_row + 1) * side}, priority.bounds());
    for (int y = rows.y0; y < rows.y1; ++y) {
      const T* row = priority.row(y).data();
      for (int x0 = 0; x0 < priority.width(); x0 += side) {
        if (!(maxima_.of_row(image, y, x0 / side) > lower)) continue;
        const int x1 = x0 + side < priority.width() ? x0 + side : priority.width();
        for (int x = x0; x < x1; ++x) {
          if (row[x] > lower && row[x] <= upper_) found.push_back({row[x], place_of(image, x, y)});
        }
      }
    }
  }
}

template <class T>
bool PriorityOrder<T>::gather() {
  batch_.clear();
  while (batch_.empty() && upper_ > 0.0) {
    const std::size_t per_sample = std::max<std::size_t>(entries_ / (sampled_.size() + 1), 1);
    sampled_used_ += std::max<std::size_t>(4 * expected_ / per_sample, 4);
    const double lower = sampled_used_ < sampled_.size() ? sampled_[sampled_used_] : 0.0;
    if (lower >= upper_) continue;  // many equal priorities
    parallel_for(of_row_.size(), [&](std::size_t r) {
      of_row_[r].clear();
      gather_rows(static_cast<int>(r), lower, of_row_[r]);
    });
    for (const std::vector<Candidate>& found : of_row_)
      batch_.insert(batch_.end(), found.begin(), found.end());
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
  std::uint64_t lowest = ~std::uint64_t{0}, highest = 0;
  for (const Candidate& candidate : batch_) {
    const std::uint64_t rank = rank_of(candidate.priority);
    lowest = std::min(lowest, rank);
    highest = std::max(highest, rank);
  }
  int shift = 0;
  while ((highest - lowest) >> shift >= kBuckets)
    ++shift;
  const auto bucket_of = [&](const Candidate& candidate) {
    return static_cast<std::size_t>((highest - rank_of(candidate.priority)) >> shift);
  };
  std::vector<std::size_t> begin(kBuckets + 1, 0);
  for (const Candidate& candidate : batch_)
    ++begin[bucket_of(candidate) + 1];
  for (std::size_t i = 1; i < begin.size(); ++i)
    begin[i] += begin[i - 1];
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
