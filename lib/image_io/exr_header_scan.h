// The headers of an OpenEXR file, read before OpenEXR reads them: its reader takes memory on the
// word of an attribute, of a preview's sides, and of the window that a table of chunks is made for.
//
// A file is let through when every attribute lies inside it and has the size of its type, so that
// OpenEXR finds the next one where the scan did; when the tables of chunks of all parts fit into
// the rest of it; and when no chunk is larger than its length allows. Layout: "OpenEXR File
// Layout", of the OpenEXR documentation.
#pragma once

#include <cstdint>
#include <filesystem>

#include "lib/core/error.h"

namespace spool::exr {

// A chunk of this size is never refused, as pictures of one colour are short.
inline constexpr std::uint64_t kPlainChunkBytes = std::uint64_t{32} << 20;

// The length of the file. Errors: kIo unreadable, kData not OpenEXR, kDamage for a header that
// claims more than is there, naming the attribute.
Result<std::uint64_t> scan_headers(const std::filesystem::path& path);

}  // namespace spool::exr
