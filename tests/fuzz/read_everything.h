// Opens, checks and reads a file in every way the reader offers.
#pragma once

#include "formats/dump_check.h"
#include "formats/dump_geometry.h"
#include "formats/spool_reader.h"
#include "tests/fuzz/fuzz_input.h"

namespace spool::format {

inline volatile uint64_t read_sink = 0;  // keeps the compiler from dropping the reads

template <class T>
void sink(const std::vector<T>& values) {
  if (!values.empty())
    read_sink = read_sink + static_cast<uint64_t>(values.back() == values.front());
}

inline void read_everything(const std::filesystem::path& path) {
  const auto report = check_dump(path);
  const auto reader = SpoolReader::open(path);
  demand(!report || report->opens == reader.has_value(), "check and open agree");
  demand(report || !reader, "what opens can be checked");
  if (!reader) {
    demand(reader.error().message.find('\n') == std::string::npos, "an error is one line");
    return;
  }
  const DumpGeometry geometry(reader->header());
  // A sound file may be large on paper; its samples are bounded by what it really holds.
  uint32_t budget = 64;
  for (uint16_t group = 0; group < geometry.groups().size(); ++group) {
    const GroupLayout& layout = geometry.groups()[group];
    for (uint32_t tile = 0; tile < layout.tiles && budget > 0; ++tile) {
      for (uint32_t block = 0; block < layout.blocks && budget > 0; ++block) {
        if (!reader->has_block(group, tile, block)) continue;
        --budget;
        const auto plain = reader->read_block(group, tile, block);
        if (plain) sink(*plain);
        demand(plain || !report->intact(), "an intact file can be read");
        const auto mapped = reader->map_block(group, tile, block);
        demand(mapped.has_value() == (reader->is_raw(group, tile, block) && plain.has_value()),
               "raw blocks can be mapped");
        if (mapped) demand(std::ranges::equal(*mapped, *plain), "mapping and reading agree");
      }
    }
  }
  const PixelRect corner = {0, 0, std::min(16u, reader->header().width),
                            std::min(16u, reader->header().height)};
  for (const LayerInfo& layer : reader->layers()) {
    if (const auto region = reader->read_region(layer.name, corner, 0, 1)) sink(*region);
    if (reader->header().width > 256 || reader->header().height > 256) continue;
    if (const auto pixels = reader->read_pixel_layer(layer.name)) sink(*pixels);
    if (const auto passes = reader->read_pass_layer(layer.name)) sink(*passes);
  }
}

}  // namespace spool::format
