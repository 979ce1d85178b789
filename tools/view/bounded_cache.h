// The values used last, by key, as many as fit into so many bytes.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <string>
#include <utility>

namespace spool::tools {

// Not safe by itself for several threads.
template <class Value>
class BoundedCache {
 public:
  explicit BoundedCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Null where it is not kept; otherwise it is the last one used from now on.
  std::shared_ptr<const Value> find(const std::string& key) {
    for (auto at = entries_.begin(); at != entries_.end(); ++at) {
      if (at->key != key) continue;
      entries_.splice(entries_.begin(), entries_, at);
      return entries_.front().value;
    }
    return nullptr;
  }
  // What alone is larger than the cache is not kept.
  void insert(std::string key, std::shared_ptr<const Value> value, std::size_t bytes) {
    if (bytes > most_bytes_) return;
    entries_.push_front({std::move(key), std::move(value), bytes});
    bytes_ += bytes;
    while (bytes_ > most_bytes_) {
      bytes_ -= entries_.back().bytes;
      entries_.pop_back();
    }
  }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
    std::size_t bytes;
  };
  std::list<Entry> entries_;  // the last one used first
  std::size_t most_bytes_, bytes_ = 0;
};

}  // namespace spool::tools
