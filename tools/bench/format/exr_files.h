// The same samples in OpenEXR [OpenExr]: one deep file (ZIPS), or a folder of one flat image per
// sample. By OpenEXR's own library in one thread; what it throws is not caught.
#pragma once

#include <filesystem>

#include "tools/bench/format/recorded_samples.h"

namespace spool::bench {

void write_deep_exr(const std::filesystem::path& path, RecordedSamples& samples);
void read_deep_exr(const std::filesystem::path& path, RecordedSamples& into);

void write_flat_exr(const std::filesystem::path& folder, RecordedSamples& samples, bool zip);
void read_flat_exr(const std::filesystem::path& folder, RecordedSamples& into);

}  // namespace spool::bench
