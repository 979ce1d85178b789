// The rules of formats/spool.md about the image: its size, its channels, the order of its samples.
//
// The functions judge bytes or values and touch no file, like those of header_rules.h.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formats/dump_header.h"
#include "formats/structures.h"
#include "formats/violation.h"

namespace spool::format {

// Contents of IMAG and CHAN (step 8).
Judged<DumpHeader> parse_dump_header(std::span<const std::byte> imag,
                                     std::span<const std::byte> chan, const FileHeader& header);

// Sections 4.1, 4.2 and 6.
Judged<void> check_dump_header(const DumpHeader& header);

// Section 4.2, of the channels alone.
Judged<void> check_channels(const std::vector<ChannelInfo>& channels);

UnitBytes encode_imag(const DumpHeader& header);
UnitBytes encode_channel(const ChannelInfo& channel);

}  // namespace spool::format
