#include "lib/sampling/multiscale/greedy_order.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

namespace {

// Independent maxima, joined at the end: the largest value is the same in any order.
SPOOL_VECTOR_CLONES
double largest_of(const double* row, int width) {
  double lanes[8];
  std::fill_n(lanes, 8, -std::numeric_limits<double>::infinity());
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    for (int i = 0; i < 8; ++i)
      lanes[i] = row[x + i] > lanes[i] ? row[x + i] : lanes[i];
  }
  for (; x < width; ++x)
    lanes[0] = row[x] > lanes[0] ? row[x] : lanes[0];
  return *std::max_element(lanes, lanes + 8);
}

// Level, then y, then x, of 16, 24 and 24 bits.
std::uint64_t place_of(int level, int x, int y) {
  return static_cast<std::uint64_t>(level) << 48 | static_cast<std::uint64_t>(y) << 24 |
         static_cast<std::uint64_t>(x);
}
RegionEntry entry_at(std::uint64_t place, double priority) {
  constexpr std::uint64_t kMask = (1u << 24) - 1;
  return {static_cast<int>(place >> 48), static_cast<int>(place & kMask),
          static_cast<int>(place >> 24 & kMask), priority};
}

// Priorities in their order as whole numbers, also negative ones.
std::uint64_t rank_of(double priority) {
  const auto bits = std::bit_cast<std::uint64_t>(priority + 0.0);  // -0 ranks with 0
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return bits & kSign ? ~bits : bits | kSign;
}

}  // namespace

PriorityMaxima::PriorityMaxima(const BlockGrid& grid, const Board& board) : grid_(grid) {
  maxima_.assign(board.priority.size(), Plane(grid.across(), board.window.height()));
  for (std::size_t l = 0; l < board.priority.size(); ++l) {
    for (std::size_t b = 0; b < grid_.size(); ++b)
      refresh(board, static_cast<int>(l) + 1, b, grid_[b].y0, grid_[b].y1);
  }
}

void PriorityMaxima::refresh(const Board& board, int level, std::size_t b, int y0, int y1) {
  const auto l = static_cast<std::size_t>(level) - 1;
  const Rectangle block = grid_[b];
  for (int y = y0; y < y1; ++y) {
    maxima_[l](block.x0 / BlockGrid::kBlockSide, y) =
        largest_of(&board.priority[l](block.x0, y), block.width());
  }
}

GreedyOrder::GreedyOrder(const Board& board, const PriorityMaxima& maxima, double above,
                         std::size_t expected)
    : board_(board),
      maxima_(maxima),
      above_(above),
      expected_(std::max<std::size_t>(expected, 16)),
      upper_(std::numeric_limits<double>::infinity()),
      of_row_(static_cast<std::size_t>(maxima.grid().down())),
      taken_(board.window.width(), board.window.height()) {
  constexpr std::size_t kSampled = 1 << 12;
  for (const Plane& plane : board.priority)
    entries_ += plane.size();
  const std::size_t stride = (entries_ / kSampled) | 1;
  for (const Plane& plane : board.priority) {
    for (std::size_t i = 0; i < plane.size(); i += stride) {
      if (plane[i] > above_) sampled_.push_back(plane[i]);
    }
  }
  std::sort(sampled_.begin(), sampled_.end(), std::greater<>());
}

bool GreedyOrder::is_free(const RegionEntry& entry) const {
  const Rectangle r = sampled_region(board_, entry);
  for (int y = r.y0; y < r.y1; ++y) {
    const std::uint8_t* row = &taken_(0, y);
    if (std::any_of(row + r.x0, row + r.x1, [](std::uint8_t taken) { return taken != 0; })) {
      return false;
    }
  }
  return true;
}

void GreedyOrder::take(const RegionEntry& entry) {
  const Rectangle r = sampled_region(board_, entry);
  for (int y = r.y0; y < r.y1; ++y)
    std::fill(&taken_(0, y) + r.x0, &taken_(0, y) + r.x1, std::uint8_t{1});
}

// Entries of one row of blocks with lower < priority <= upper_.
void GreedyOrder::gather_rows(int block_row, double lower, std::vector<Candidate>& found) const {
  const BlockGrid& grid = maxima_.grid();
  const auto block = [&](int column) {
    const auto b = static_cast<std::size_t>(block_row) * grid.across() + column;
    return intersect(grid[b], board_.area);
  };
  const Rectangle rows = block(board_.area.x0 / BlockGrid::kBlockSide);
  for (std::size_t l = 0; l < board_.priority.size(); ++l) {
    const int level = static_cast<int>(l) + 1;
    for (int y = rows.y0; y < rows.y1; ++y) {
      const double* row = board_.priority[l].row(y).data();
      for (int column = 0; column < grid.across(); ++column) {
        if (!(maxima_(l, y, column) > lower)) continue;
        const Rectangle columns = block(column);
        for (int x = columns.x0; x < columns.x1; ++x) {
          if (row[x] > lower && row[x] <= upper_) found.push_back({row[x], place_of(level, x, y)});
        }
      }
    }
  }
}

bool GreedyOrder::gather() {
  batch_.clear();
  while (batch_.empty() && upper_ > above_) {
    const std::size_t per_sample = std::max<std::size_t>(entries_ / (sampled_.size() + 1), 1);
    sampled_used_ += std::max<std::size_t>(4 * expected_ / per_sample, 4);
    const double lower = sampled_used_ < sampled_.size() ? sampled_[sampled_used_] : above_;
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

void GreedyOrder::lay_out() {
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

bool GreedyOrder::next_bucket() {
  if (bucket_ == bucket_end_.size()) return false;
  used_ = bucket_ == 0 ? 0 : bucket_end_[bucket_ - 1];
  const auto first = batch_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto end = batch_.begin() + static_cast<std::ptrdiff_t>(bucket_end_[bucket_++]);
  const auto last = std::remove_if(first, end, [&](const Candidate& candidate) {
    return !is_free(entry_at(candidate.place, candidate.priority));
  });
  bucket_last_ = used_ + static_cast<std::size_t>(last - first);
  std::sort(first, last, [](const Candidate& a, const Candidate& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.place < b.place;
  });
  return true;
}

RegionEntry GreedyOrder::next() {
  while (true) {
    for (; used_ < bucket_last_; ++used_) {
      const RegionEntry entry = entry_at(batch_[used_].place, batch_[used_].priority);
      if (is_free(entry)) return entry;
    }
    if (!next_bucket() && !gather()) return {};
  }
}

}  // namespace spool
