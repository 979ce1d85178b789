// Shows another implementation what the C++ reader and writer do:
//   rewrite IN OUT ...   reads each dump and writes it again: meta first, then group, tile, block
//   recover IN OUT ...   0 all, 4 something lost, or the exit code and the message
//   check FILE ...       one line per file: 0 intact, 4 damaged, or the exit code and the message
//   samples FILE ...     one line per file: 0 and the digest of all blocks, or the refusal
#include <cstdio>
#include <span>
#include <string_view>
#include <vector>

#include "formats/crc32.h"
#include "formats/dump_check.h"
#include "formats/spool_reader.h"
#include "formats/spool_recovery.h"
#include "formats/spool_writer.h"

namespace {

using namespace spool;
using namespace spool::format;

struct BlockKey {
  uint16_t group;
  uint32_t tile, block;
};

// Every block that the file holds, by group, tile and block.
std::vector<BlockKey> blocks_of(const SpoolReader& reader) {
  std::vector<BlockKey> keys;
  for (uint32_t group = 0; group < reader.group_count(); ++group) {
    const auto number = static_cast<uint16_t>(group);
    for (uint32_t tile = 0; tile < reader.tiles(); ++tile)
      for (uint32_t block = 0; block < reader.blocks(); ++block)
        if (reader.has_block(number, tile, block)) keys.push_back({number, tile, block});
  }
  return keys;
}

Result<void> rewrite(const char* in, const char* out) {
  SPOOL_ASSIGN(const SpoolReader reader, SpoolReader::open(in));
  WriterOptions options;
  options.uuid = reader.header().uuid;
  options.force = true;
  SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::create(out, reader.header(), options));
  for (const std::string& text : reader.meta())
    SPOOL_TRY(writer.write_meta(text));
  for (const auto [group, tile, block] : blocks_of(reader)) {
    SPOOL_ASSIGN(const auto payload, reader.read_block(group, tile, block));
    Scope scope = Scope::kSample;
    for (const ChannelInfo& channel : reader.header().channels)
      if (channel.group == group) scope = channel.scope;
    const bool pixel = scope == Scope::kPixel;
    SPOOL_TRY(writer.write_block(group, tile, pixel ? 0 : reader.block_begin(block),
                                 pixel ? 1 : reader.block_count(block), payload));
  }
  return writer.finish();
}

// crc32 over 32-bit words: for each block the digest so far, then the CRC of its bytes or, when it
// cannot be read, the exit code.
Result<uint32_t> digest(const char* path) {
  SPOOL_ASSIGN(const SpoolReader reader, SpoolReader::open(path));
  uint32_t sum = 0;
  for (const auto [group, tile, block] : blocks_of(reader)) {
    const auto payload = reader.read_block(group, tile, block);
    const uint32_t words[] = {
        sum, payload ? crc32(*payload) : static_cast<uint32_t>(payload.error().code)};
    sum = crc32(std::as_bytes(std::span(words)));
  }
  return sum;
}

void print(const Result<void>& result) {
  if (result)
    std::puts("0");
  else
    std::printf("%d %s\n", static_cast<int>(result.error().code), result.error().message.c_str());
}

Result<void> check(const char* path) {
  SPOOL_ASSIGN(const CheckReport report, check_dump(path));
  if (report.intact()) return {};
  return fail(ErrorCode::kDamage, "{}", report.damaged.empty() ? "" : report.damaged[0].reason);
}

Result<void> recover(const char* in, const char* out) {
  SPOOL_ASSIGN(const RecoveryReport report, recover_dump(in, out));
  if (!report.anything_lost()) return {};
  return fail(ErrorCode::kDamage, "{} blocks kept", report.kept_blocks);
}

}  // namespace

int main(int count, char** arguments) {
  const std::string_view verb = count > 1 ? arguments[1] : "";
  for (int i = 2; i < count; ++i) {
    if (verb == "rewrite" && i + 1 < count) {
      print(rewrite(arguments[i], arguments[i + 1]));
      ++i;
    } else if (verb == "recover" && i + 1 < count) {
      print(recover(arguments[i], arguments[i + 1]));
      ++i;
    } else if (verb == "check") {
      print(check(arguments[i]));
    } else if (verb == "samples") {
      const Result<uint32_t> sum = digest(arguments[i]);
      if (sum)
        std::printf("0 %u\n", *sum);
      else
        print(sum.map([](uint32_t) {}));
    } else {
      return 2;
    }
  }
  return 0;
}
