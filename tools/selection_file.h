// A selection as an EXR: how many samples of each piece were taken, and what a sampler hands on.
//
// Channel `n` (uint): samples of each piece. Layers `A.0` .. `A.K` (float): attenuation of each
// level, where the sampler keeps one. Attributes of files written here say which sampler made it,
// the order of the samples and the exposure, so that `reconstruct` sees the same prefix. Any image
// of counts will do: without `n`, channel Y or R or the first one is taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/error.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool::tools {

struct SelectionInfo {
  std::string sampler;
  std::string dump;
  PoolOptions pool;
};

Result<void> write_selection(const std::filesystem::path& path, const Selection& selection,
                             const SelectionInfo& info, bool overwrite);

struct SelectionFile {
  CountImage n;
  std::vector<Plane> attenuation;
  std::optional<double> exposure;
  std::optional<PoolOptions> pool;  // absent in images made elsewhere
};

// Counts must be whole and not negative; kData with the pixel otherwise.
Result<SelectionFile> read_selection(const std::filesystem::path& path);

// The statistics of that selection. kData where the file's size is not the pool's or a count is
// larger than the pool's capacity there.
Result<Selection> apply_selection(const SelectionFile& file, const std::filesystem::path& path,
                                  const SamplePool& pool);

}  // namespace spool::tools
