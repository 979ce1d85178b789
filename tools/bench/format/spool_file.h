// The samples of the comparison in a `.spool` file, in one thread; a failure ends the program.
#pragma once

#include <filesystem>

#include "tools/bench/format/recorded_samples.h"

namespace spool::bench {

// The recordings below each other; all must have the same width, samples and channels. Layers of
// other scopes than `sample` are left out.
RecordedSamples stacked_recordings(const std::vector<std::filesystem::path>& paths);

void write_spool(const std::filesystem::path& path, const RecordedSamples& samples, bool compress);
// Decodes every block and puts its samples where they belong.
void read_spool(const std::filesystem::path& path, RecordedSamples& into);
// The sum of all 64-bit words of the mapped blocks of group 0, twice: the first time each block is
// verified. Returns the CPU seconds of both.
struct MappedSums {
  uint64_t first = 0, second = 0;
  double first_seconds = 0, second_seconds = 0;
};
MappedSums sum_mapped(const std::filesystem::path& path);

uint64_t sum_of_words(const std::byte* data, size_t bytes);
double cpu_seconds();

}  // namespace spool::bench
