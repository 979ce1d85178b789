// An image of counts: a selection, or the answer of a sampler that is another program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "lib/core/error.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/foreign_picture.h"

namespace spool {

// All channels of the part with a channel n, or of the only part. kData where several parts could
// be meant, and where the data window is not the display window or has another size.
Result<ExrFile> read_counts_exr(const std::filesystem::path& path,
                                const std::optional<NeededSize>& needed = {});

// The index of n, of the only channel, of Y where it is no part of X, Y, Z, or of R where G and B
// are the same. kData for everything else: which is meant must not depend on the alphabet.
Result<std::size_t> count_channel(const ExrFile& file, const std::string& name);

}  // namespace spool
