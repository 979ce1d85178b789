// Where the samples of a call come from: a file, or arrays in memory.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
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

// A file on this machine, whatever its names.
struct FileId {
  std::uint64_t device, inode;
  bool operator==(const FileId&) const = default;
};

class Source {
 public:
  Source(std::filesystem::path path, FileId opened) : name_(std::move(path)), opened_(opened) {}
  Source(std::string name, SampleArrays arrays)
      : name_(std::move(name)), arrays_(std::move(arrays)) {}

  // What load_recording() gives; the last two are kept. From any thread. Error (kUsage): a file
  // that is no longer the one that was opened.
  Result<std::shared_ptr<const RecordedSamples>> load(const SanitiseRules& rules,
                                                      const WorkingMemory& work, SampleFilm film);
  std::string name() const { return name_.string(); }
  Result<void> is_that_file() const;  // of a file, not of arrays

 private:
  struct Loaded {
    OptionValues rules;
    SampleFilm film;
    std::shared_ptr<const RecordedSamples> samples;
  };

  std::filesystem::path name_;
  FileId opened_{};
  std::optional<SampleArrays> arrays_;
  std::mutex mutex_;
  std::vector<Loaded> kept_;
};

}  // namespace spool::python
