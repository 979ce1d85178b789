// Inside lib/image_io: what every EXR reader asks of a header before it believes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPixelType.h>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool::exr {

// No codec of OpenEXR reaches this ratio on real data (deflate ends at 1032:1), so a header that
// claims more than this times the length of its file lies.
inline constexpr std::uint64_t kMaxExpansion = 4096;
inline constexpr int kMaxSide = 1 << 20;

struct Window {
  int width = 0;
  int height = 0;
};

// Puts OpenEXR's own caps in place; before any file is opened.
void cap_sizes();

// The data window, within kMaxSide and `max_pixels`.
Result<Window> checked_window(const std::string& name, const Imf::Header& header,
                              std::uint64_t max_pixels);
Result<std::vector<ExrChannel>> checked_channels(const std::string& name,
                                                 const Imf::Header& header);
// kData for a subsampled channel.
Result<void> check_full_size(const std::string& name, const ExrChannel& channel);
// `claimed` bytes of pixels against the cap and the length of the file.
Result<void> check_claim(const std::string& name, const Window& window, std::size_t channels,
                         std::uint64_t claimed, std::uint64_t max_bytes, std::uint64_t file_bytes);

void read_attributes(const Imf::Header& header, ExrAttributes& attributes);
void write_attributes(const ExrAttributes& attributes, Imf::Header& header);

Imf::PixelType imf_type(PixelType type);

}  // namespace spool::exr
