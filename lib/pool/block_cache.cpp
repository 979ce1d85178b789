#include "lib/pool/block_cache.h"

#include <list>
#include <mutex>
#include <utility>
#include <vector>

namespace spool {
namespace {

class BlockCache {
 public:
  BlockCache(BlockReader reader, const LayerGrid& grid, int channels, std::uint64_t bytes)
      : reader_(std::move(reader)),
        grid_(grid),
        channels_(channels),
        bytes_(bytes),
        places_(grid.count(), order_.end()) {}

  Result<BlockValues> block(std::size_t index) {
    {
      const std::scoped_lock lock(mutex_);
      const auto place = places_[index];
      if (place != order_.end()) {
        order_.splice(order_.begin(), order_, place);
        return place->values;
      }
      make_room(bytes_of(index));
    }
    // Two threads may read the same block; the second one finds it there and drops its own.
    SPOOL_ASSIGN(BlockValues values, reader_(index));
    if (values.held == nullptr) return values;
    const std::scoped_lock lock(mutex_);
    if (places_[index] == order_.end()) {
      make_room(bytes_of(index));
      order_.push_front({index, values});
      places_[index] = order_.begin();
      kept_ += bytes_of(index);
    }
    return values;
  }

 private:
  struct Entry {
    std::size_t index;
    BlockValues values;
  };

  std::uint64_t bytes_of(std::size_t index) const {
    const auto blocks = static_cast<std::size_t>(grid_.blocks());
    return static_cast<std::uint64_t>(grid_.tile(static_cast<int>(index / blocks)).area()) *
           grid_.samples(static_cast<int>(index % blocks)) * channels_ * sizeof(float);
  }

  void make_room(std::uint64_t bytes) {
    while (!order_.empty() && kept_ + bytes > bytes_) {
      kept_ -= bytes_of(order_.back().index);
      places_[order_.back().index] = order_.end();
      order_.pop_back();
    }
  }

  BlockReader reader_;
  LayerGrid grid_;
  int channels_;
  std::uint64_t bytes_, kept_ = 0;
  std::mutex mutex_;
  std::list<Entry> order_;                          // the one asked for last is the first
  std::vector<std::list<Entry>::iterator> places_;  // by index; end() where it is not kept
};

}  // namespace

BlockReader cached_blocks(BlockReader reader, const LayerGrid& grid, int channels,
                          std::uint64_t bytes) {
  const auto cache = std::make_shared<BlockCache>(std::move(reader), grid, channels, bytes);
  return [cache](std::size_t index) { return cache->block(index); };
}

}  // namespace spool
