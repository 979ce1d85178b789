// Decisions -> calls in any order with any arguments: errors, never a crash, never a broken file.
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace spool::format;

// Small numbers mostly, and now and then any number.
uint32_t any(Decisions& decisions) {
  const uint8_t kind = decisions.byte();
  return kind < 200 ? kind % 8u : decisions.next();
}

void use_reader(Decisions& decisions, const SpoolReader& reader) {
  const auto group = static_cast<uint16_t>(any(decisions));
  const uint32_t tile = any(decisions);
  const uint32_t block = any(decisions);
  constexpr std::array<std::string_view, 5> kLayers = {"radiance", "film", "reference", "path",
                                                       "none"};
  const std::string_view layer = kLayers[decisions.up_to(4)];
  switch (decisions.up_to(6)) {
    case 0:
      static_cast<void>(reader.read_block(group, tile, block));
      break;
    case 1:
      static_cast<void>(reader.map_block(group, tile, block));
      break;
    case 2:
      demand(
          reader.has_block(group, tile, block) == reader.read_block(group, tile, block).has_value(),
          "blocks of an intact file can be read");
      break;
    case 3: {
      const PixelRect rect = {any(decisions), any(decisions), any(decisions), any(decisions)};
      const uint32_t begin = any(decisions);
      const uint32_t count = any(decisions);
      static_cast<void>(reader.read_region(layer, rect, begin, count));
      break;
    }
    case 4:
      static_cast<void>(reader.read_pixel_layer(layer));
      break;
    case 5:
      static_cast<void>(reader.read_pass_layer(layer));
      break;
    default:
      static_cast<void>(reader.is_raw(group, tile, block));
  }
}

void use_writer(Decisions& decisions, SpoolWriter& writer, const MadeDump& dump) {
  const DumpGeometry geometry(dump.header);
  const auto group = static_cast<uint16_t>(any(decisions));
  const uint32_t tile = any(decisions);
  const uint32_t begin = any(decisions);
  const uint32_t count = any(decisions);
  switch (decisions.up_to(3)) {
    case 0:
      static_cast<void>(writer.write_meta(decisions.up_to(1) == 1 ? "{}" : "[]"));
      break;
    case 1:
      static_cast<void>(writer.write_block(group, tile, begin, count, Bytes(decisions.byte())));
      break;
    case 2: {
      const auto block = geometry.block_of(group, begin);
      if (!block || !geometry.slot(group, tile, *block)) break;
      const bool there = writer.has_block(group, tile, *block);
      const auto written =
          writer.write_block(group, tile, begin, geometry.block_count(group, *block),
                             block_bytes(geometry, group, tile, *block, 1, false));
      demand(!there || !written, "no block is written twice");
      break;
    }
    default:
      static_cast<void>(writer.has_block(group, tile, begin));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Decisions decisions(data, size);
  MadeDump dump = rich_dump(decisions.up_to(1) == 1);
  dump.options.force = true;
  const auto& path = fuzz_file("in");
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  {
    auto writer = SpoolWriter::create(path, dump.header, dump.options);
    demand(writer.has_value(), "a writer can be made");
    for (int i = 0; i < 40 && !decisions.empty(); ++i)
      use_writer(decisions, *writer, dump);
    if (decisions.up_to(3) == 0) {  // dropped and taken up again
      SpoolWriter dropped = std::move(*writer);
      writer = tl::unexpected(spool::Error{});
      {
        const SpoolWriter gone = std::move(dropped);
      }
      writer = SpoolWriter::resume(path, dump.options);
      demand(writer.has_value(), "an unfinished dump can be resumed");
    }
    demand(writer->finish().has_value(), "a dump can be finished at any time");
    demand(!writer->finish().has_value(), "but once");
  }
  const auto report = check_dump(path);
  demand(report && report->intact(), "whatever the calls, the file is sound");
  const auto reader = SpoolReader::open(path);
  demand(reader.has_value(), "and opens");
  for (int i = 0; i < 40 && !decisions.empty(); ++i)
    use_reader(decisions, *reader);
  return 0;
}
