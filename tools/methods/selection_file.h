// A selection as an EXR: how many samples of each piece were taken, and what a sampler hands on.
//
// Channel `n` (uint): samples of each piece. Layers `A.0` .. `A.K` (float): attenuation of each
// level, where the sampler keeps one; where they are more than floats, `A_bits.k.high` and
// `A_bits.k.low` (uint) are the same in all 64 bits, and count as long as `A.k` has not been
// changed since. Attributes of files
// written here say which sampler made it, the order of the samples and the analysis signal, so that
// `reconstruct` gives the very bits that `evaluate` gives. A selection with halves has the same
// channels once more for each, `even.n`, `even.A.0`, .. `odd.n`, ..; `n` is all that was looked at
// in a split decision, and the sum of both where the attribute spool.halves is "together". Any
// image of counts will do: lib/image_io/counts_exr.h says which channel is meant.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/error.h"
#include "lib/core/view.h"
#include "lib/image_io/exr_image.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool::tools {

struct SelectionInfo {
  std::string sampler;
  std::string dump;
  PoolOptions pool;
};

Result<void> write_selection(const std::filesystem::path& path, const Selection& selection,
                             const SelectionInfo& info, bool overwrite,
                             const Views* views = nullptr);

struct SelectionFile {
  CountImage n;
  std::vector<Plane> attenuation;
  std::optional<AnalysisSignal> signal;
  std::optional<PoolOptions> pool;  // absent in images made elsewhere
  std::vector<SelectionFile> halves = {};
  HalvesUse halves_use = HalvesUse::kApart;
};

// The counts in an image (lib/image_io/counts_exr.h); kData where one is no count.
Result<CountImage> counts_from_exr(const ExrFile& file, const std::string& name);

// What a file of `selection` holds, without the file.
SelectionFile contents_of(const Selection& selection, const PoolOptions& pool);

// Counts must be whole and not negative; kData with the pixel otherwise.
Result<SelectionFile> read_selection(const std::filesystem::path& path);

// What of the statistics is made. Without the analysis signal they have it as it is before any
// exposure, which is enough to expose it (lib/kernels/piece_estimates.h).
enum class Made { kAll, kWithoutSignal, kMeans };

// The statistics of that selection. kData where the file's size is not the pool's, a count is
// larger than the pool's capacity there, or halves that are used together have another sum than
// `n`.
Result<Selection> apply_selection(const SelectionFile& file, const std::filesystem::path& path,
                                  const SamplePool& pool, Made made = Made::kAll);

}  // namespace spool::tools
