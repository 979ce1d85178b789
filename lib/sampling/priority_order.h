// The entries of priority images one after the other, in the order of `precedes`.
//
// Entries are gathered in batches of falling priority, and a batch is laid into buckets of which
// each is sorted when its turn comes, so that the whole is never sorted; where batches and buckets
// are cut does not change the order.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/sampling/priority_maxima.h"

namespace spool {

// Entries with a priority > 0 that are free when their turn comes.
template <class T>
class PriorityOrder {
 public:
  using IsFree = std::function<bool(const RegionEntry&)>;

  // `expected`: about how many entries will be asked for. `is_free`: an entry that is not free once
  // is not free later. The maxima and their images must outlive this and keep their values.
  PriorityOrder(const PriorityMaxima<T>& maxima, std::size_t expected, IsFree is_free);

  // None when there is none left.
  std::optional<RegionEntry> next();

 private:
  // The smaller place precedes among equal priorities: images one after the other, row by row.
  struct Candidate {
    T priority;
    std::uint32_t place;
  };

  RegionEntry entry_of(const Candidate& candidate) const;
  bool gather();       // fills batch_ with the entries of the next range of priorities
  void lay_out();      // batch_ into buckets of falling priority
  bool next_bucket();  // sorts the free entries of the next bucket
  // body(run, place of its first entry) for the runs of entries in a row of blocks of which some
  // have a priority > lower.
  template <class Body>
  void for_each_run(std::size_t block_row, double lower, const Body& body) const;

  const PriorityMaxima<T>& maxima_;
  std::size_t expected_;
  IsFree is_free_;
  std::vector<double> sampled_;  // some priorities: where to cut; the largest, used ones first
  std::size_t sampled_used_ = 0;
  double upper_;  // entries with priority > upper_ were gathered
  std::size_t entries_ = 0;
  std::vector<std::size_t> image_begin_;  // places of images; one more than there are images
  std::vector<std::size_t> row_end_;      // [row of blocks] in batch_
  std::vector<Candidate> batch_;
  std::vector<std::size_t> bucket_end_;
  std::size_t bucket_ = 0;                  // the next one
  std::size_t used_ = 0, bucket_last_ = 0;  // of the present bucket: batch_[used_, bucket_last_)
};

}  // namespace spool
