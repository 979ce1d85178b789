// Samples in memory as one array per channel, [y][x][s]: what every format of the comparison is
// written from and read into.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/dump_header.h"

namespace spool::bench {

struct SampleChannel {
  format::ChannelInfo about;
  std::vector<std::byte> values;  // [y][x][s]
  size_t value_bytes() const { return about.type == format::DataType::kFloat16 ? 2 : 4; }
};

struct RecordedSamples {
  uint32_t width = 0, height = 0, spp = 0;
  std::vector<SampleChannel> channels;

  uint64_t bytes() const {
    uint64_t sum = 0;
    for (const SampleChannel& channel : channels)
      sum += channel.values.size();
    return sum;
  }
  uint64_t samples() const { return uint64_t{width} * height * spp; }
};

}  // namespace spool::bench
