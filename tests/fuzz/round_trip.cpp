// Decisions -> a dump -> written and read back.
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace spool::format;

MadeDump decide(Decisions& decisions) {
  MadeDump dump;
  dump.header =
      small_header(1 + decisions.up_to(19), 1 + decisions.up_to(19), 1 + decisions.up_to(5),
                   1 + decisions.up_to(5), 8u << decisions.up_to(5),
                   static_cast<DataType>(1 + decisions.up_to(1)));
  const uint32_t groups = decisions.up_to(4);
  for (uint32_t g = 0; g < groups; ++g) {
    std::vector<std::string> names;
    const uint32_t channels = 1 + decisions.up_to(3);
    for (uint32_t c = 0; c < channels; ++c) {
      names.push_back("layer_" + std::to_string(g) + ".C" + std::to_string(c));
    }
    add_group(dump.header, names, static_cast<DataType>(1 + decisions.up_to(2)),
              static_cast<Scope>(decisions.up_to(2)));
  }
  dump.options.force = true;
  dump.options.compress = decisions.up_to(1) == 1;
  dump.smooth = decisions.up_to(1) == 1;
  dump.skip_every = decisions.up_to(5);
  dump.seed = decisions.next();
  if (decisions.up_to(1) == 1) dump.meta = {"{\"n\":" + std::to_string(decisions.next()) + "}"};
  return dump;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Decisions decisions(data, size);
  const MadeDump dump = decide(decisions);
  const auto& path = fuzz_file("in");
  demand(make_dump(path, dump).has_value(), "a valid dump can be written");
  const auto reader = SpoolReader::open(path);
  demand(reader.has_value(), "a written dump opens");
  const DumpGeometry geometry(dump.header);
  for (uint16_t group = 0; group < geometry.groups().size(); ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        if (is_skipped(dump, *geometry.slot(group, tile, block))) continue;
        const auto read = reader->read_block(group, tile, block);
        demand(read && *read == block_bytes(geometry, group, tile, block, dump.seed, dump.smooth),
               "what is written is what is read");
      }
    }
  }
  const auto report = check_dump(path);
  demand(report && report->intact(), "a written dump is intact");
  return 0;
}
