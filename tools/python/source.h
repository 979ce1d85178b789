// Where the samples of a call come from: a file, or arrays in memory.
#pragma once

#include <nanobind/nanobind.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/pool/load_recording.h"
#include "tools/python/arrays.h"

namespace spool::python {

// Arrays of one recording, as the library reads them: no value is copied but those of the
// reference and the film positions.
struct SampleArrays {
  SampleArray radiance;  // [c][y][x][s]
  std::optional<SampleArray> film;
  std::vector<std::pair<FeatureLayer, SampleArray>> features;
  std::optional<Reference> reference;
  bool exchangeable = true;
};

class Source {
 public:
  explicit Source(std::filesystem::path path) : name_(std::move(path)) {}
  Source(std::string name, SampleArrays arrays)
      : name_(std::move(name)), arrays_(std::move(arrays)) {}

  // What load_recording() gives; the last two are kept. From any thread.
  Result<std::shared_ptr<const RecordedSamples>> load(const SanitiseRules& rules,
                                                      const WorkingMemory& work, SampleFilm film);
  std::string name() const { return name_.string(); }

 private:
  struct Loaded {
    OptionValues rules;
    SampleFilm film;
    std::shared_ptr<const RecordedSamples> samples;
  };

  std::filesystem::path name_;
  std::optional<SampleArrays> arrays_;
  std::mutex mutex_;
  std::vector<Loaded> kept_;
};

}  // namespace spool::python
