// Replays and pixels of recordings, computed on request, kept while there is room.
//
// Any number of threads may ask. One replay is computed at a time, on all threads of the program; a
// replay that its own page has asked past - a slider that went on - is given up.
#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/reference.h"
#include "lib/filters/filter.h"
#include "lib/methods/method_text.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/sampler.h"
#include "tools/verbs/one_replay.h"
#include "tools/verbs/pixel_answer.h"

namespace spool::tools {

// What can be asked for, by index; no command unless the user allowed it.
struct LiveChoices {
  struct Recording {
    std::filesystem::path path;
    std::string label;
  };
  std::vector<Recording> recordings;
  PoolOptions order;  // of every recording's samples
  std::vector<MethodChoice> samplers, filters;
  // As an evaluation has them; a recording alone is judged by its own reference.
  SanitiseRules rules = {};
  MetricOptions metrics = {};
  std::optional<ReferenceKind> reference = ReferenceKind::kIndependent;  // none: the default
  std::optional<int> holdout = {};
  std::string left_out = {};  // what cannot be replayed and why, one line; may be empty
};

struct OpenRecording {
  std::shared_ptr<const RecordedSamples> recording;
  SamplePool pool;
  ReferenceKind kind;
  std::optional<JudgingReference> reference;  // none, too, where each replay has its own
};

struct LiveReplay {
  SamplingResult sampled;
  Reconstruction result;
  std::optional<double> relmse;
};

struct ReplayKey {
  std::size_t recording = 0, sampler = 0, filter = 0;
  double spp = 0.0;
};

// Of one page, later ones are larger. Without a page nothing is given up.
struct Turn {
  std::string page;
  long long number = 0;
};

// The values used last, by key, as many as fit into so many bytes.
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

class LiveReplays {
 public:
  LiveReplays(LiveChoices choices, std::size_t most_bytes);

  const LiveChoices& choices() const { return choices_; }
  // Errors: those of load_recording; kUsage where there is no such recording.
  Result<std::shared_ptr<const OpenRecording>> open(std::size_t recording);
  // Null when a later turn of the page has come. Errors: those of the methods.
  Result<std::shared_ptr<const LiveReplay>> replay(const ReplayKey& key, const Turn& turn);
  // kUsage where there is no such pixel.
  Result<PixelAnswer> pixel(std::size_t recording, int x, int y);
  // The same with what the sampler took and the filter's footprint.
  Result<PixelAnswer> pixel(const ReplayKey& key, int x, int y);

 private:
  Result<ReplayMethods> methods_of(const ReplayKey& key) const;
  bool superseded(const Turn& turn);
  void note_turn(const Turn& turn);
  Result<std::shared_ptr<const LiveReplay>> compute(const ReplayKey& key, const Turn& turn,
                                                    const OpenRecording& from);

  const LiveChoices choices_;
  std::mutex kept_;                         // of what follows
  BoundedCache<OpenRecording> recordings_;  // counts recordings, not bytes
  BoundedCache<LiveReplay> replays_;
  std::map<std::string, long long> latest_;  // turn of each page
  std::mutex opening_, working_;
};

}  // namespace spool::tools
