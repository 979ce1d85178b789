// Walks the pixels of an image from the largest value down: what trimmed means, quantiles and
// maxima need, also when a resample counts some pixels several times and others not at all.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lib/core/image.h"

namespace spool {

// Values of the judged pixels, the largest first (ties: lower index). Only the head is sorted until
// the walk continues.
class LargestFirst {
 public:
  struct Entry {
    double value;
    std::size_t pixel;
  };

  LargestFirst(const Plane& values, const Image<std::uint8_t>& judged) {
    for (std::size_t p = 0; p < values.size(); ++p) {
      if (judged[p]) entries_.push_back({values[p], p});
    }
    sort_first(entries_.size() / 32 + 64);
  }

  // visit(entry) until it returns false.
  template <class Visit>
  void walk(Visit&& visit) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (i >= sorted_) sort_first(entries_.size());
      if (!visit(entries_[i])) return;
    }
  }

 private:
  void sort_first(std::size_t count) {
    sorted_ = std::min(count, entries_.size());
    const auto larger = [](const Entry& a, const Entry& b) {
      return a.value != b.value ? a.value > b.value : a.pixel < b.pixel;
    };
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(sorted_);
    if (end == entries_.end()) {
      std::sort(entries_.begin(), end, larger);  // the same order in a third of the time
    } else {
      std::partial_sort(entries_.begin(), end, entries_.end(), larger);
    }
  }

  std::vector<Entry> entries_;
  std::size_t sorted_ = 0;
};

}  // namespace spool
