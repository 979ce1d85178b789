#include "formats/open_dump.h"

#include <algorithm>
#include <future>
#include <system_error>
#include <thread>

#include "formats/checked_math.h"
#include "formats/chunk_codec.h"
#include "formats/crc32.h"
#include "formats/geometry_rules.h"
#include "formats/header_rules.h"
#include "formats/meta_rules.h"

namespace spool::format {

namespace {

using enum FailureClass;

// Reading a header costs a miss of every cache on its way: a large file is worth several threads.
constexpr size_t kRecordsPerThread = 8192;
constexpr size_t kMaxThreads = 8;

tl::unexpected<Error> refuse(const OpenDump& dump, const Violation& violation) {
  return tl::unexpected(file_error(dump.file.path(), violation));
}

tl::unexpected<Error> refuse_record(const OpenDump& dump, const IndexEntry& entry,
                                    const Violation& violation) {
  return refuse(dump, {violation.failure, fmt::format("{} ({})", violation.what,
                                                      describe(entry.header, entry.offset))});
}

Result<void> read_file_header(OpenDump& dump) {
  UnitBytes bytes{};
  const auto first = std::span(bytes).first(std::min<uint64_t>(dump.file_bytes, kUnit));
  SPOOL_TRY(dump.file.read_at(0, first));
  const auto header = check_file_header(first);
  if (!header) return refuse(dump, header.error());
  dump.file_header = *header;
  return {};
}

Result<void> read_footer(OpenDump& dump) {
  if (dump.file_bytes < 2 * kUnit) {
    return refuse(
        dump, {kIncomplete, fmt::format("no footer: the file ends at offset {}", dump.file_bytes)});
  }
  UnitBytes bytes{};
  SPOOL_TRY(dump.file.read_at(dump.file_bytes - kUnit, bytes));
  const auto footer = check_footer(bytes, dump.file_header, dump.file_bytes);
  if (!footer) return refuse(dump, footer.error());
  dump.footer = *footer;
  return {};
}

Result<std::vector<std::byte>> read_index(OpenDump& dump) {
  UnitBytes bytes{};
  SPOOL_TRY(dump.file.read_at(dump.footer.index_offset, bytes));
  const auto header = check_record_bytes(bytes);
  if (!header) {
    return refuse(dump,
                  {header.error().failure, fmt::format("{} (index, offset {})", header.error().what,
                                                       dump.footer.index_offset)});
  }
  const IndexEntry entry{dump.footer.index_offset, *header};
  const uint64_t entries = dump.footer.record_count - 1;
  if (const auto alone = check_record_alone(*header, dump.file_header.dump_id()); !alone) {
    return refuse_record(dump, entry, {kDamaged, alone.error().what});
  }
  if (!header->is(kTypeIndx) || header->sequence != entries ||
      header->raw_bytes != *checked_multiply(entries, kUnit)) {
    return refuse_record(dump, entry, {kDamaged, "the footer does not point to the index"});
  }
  return read_payload(dump.file, entry, true);
}

// Step 7 for one record. Its header is read from the file: the index is a cache and must not be
// believed alone.
Result<void> check_record(const OpenDump& dump, size_t i) {
  const IndexEntry& entry = dump.entries[i];
  UnitBytes bytes{};
  SPOOL_TRY(dump.file.read_at(entry.offset, bytes));
  const auto header = check_record_bytes(bytes);
  if (!header) return refuse_record(dump, entry, header.error());
  if (*header != entry.header) {
    return refuse_record(dump, entry, {kDamaged, "record header differs from the index"});
  }
  if (header->sequence != i) {
    return refuse_record(dump, entry, {kDamaged, fmt::format("sequence number should be {}", i)});
  }
  if (const auto alone = check_record_alone(*header, dump.file_header.dump_id()); !alone) {
    return refuse_record(dump, entry, alone.error());
  }
  return {};
}

// The first failure in the order of the file, whatever the number of threads.
Result<void> check_records(const OpenDump& dump) {
  const size_t count = dump.entries.size();
  const auto check_part = [&](size_t begin, size_t end) -> Result<void> {
    for (size_t i = begin; i < end; ++i)
      SPOOL_TRY(check_record(dump, i));
    return {};
  };
  const size_t parts = std::clamp<size_t>(
      std::min<size_t>(count / kRecordsPerThread, std::thread::hardware_concurrency()), 1,
      kMaxThreads);
  std::vector<std::future<Result<void>>> others;
  for (size_t part = 1; part < parts; ++part) {
    const size_t begin = count * part / parts, end = count * (part + 1) / parts;
    try {
      others.push_back(std::async(std::launch::async, check_part, begin, end));
    } catch (const std::system_error&) {  // no thread to be had: when it is asked for
      others.push_back(std::async(std::launch::deferred, check_part, begin, end));
    }
  }
  Result<void> first = check_part(0, count / parts);
  for (auto& other : others) {
    Result<void> checked = other.get();
    if (first && !checked) first = std::move(checked);
  }
  return first;
}

// Where the index says the records lie: one after the other, from the file header to the index.
Result<void> walk_records(OpenDump& dump, std::span<const std::byte> index) {
  const size_t count = index.size() / kUnit;
  dump.entries.reserve(count);
  Result<void> sound = {};
  uint64_t expected_offset = kUnit;
  for (size_t i = 0; i < count && sound; ++i) {
    const IndexEntry entry = decode_index_entry(index.subspan(i * kUnit, kUnit));
    const auto payload = checked_pad64(entry.header.stored_bytes);
    if (entry.offset != expected_offset || !fits(entry.offset, kUnit, dump.footer.index_offset)) {
      sound = refuse(dump, {kDamaged, fmt::format("index entry {} points to offset {}, expected {}",
                                                  i, entry.offset, expected_offset)});
      break;
    }
    dump.entries.push_back(entry);
    if (!payload || !fits(entry.offset + kUnit, *payload, dump.footer.index_offset)) {
      sound = refuse_record(dump, entry, {kDamaged, "payload runs into the index"});
    } else {
      expected_offset = entry.offset + kUnit + *payload;
    }
  }
  // A record that does not match its entry says more than an index that does not add up.
  SPOOL_TRY(check_records(dump));
  SPOOL_TRY(sound);
  if (expected_offset != dump.footer.index_offset) {
    return refuse(dump, {kDamaged, fmt::format("records end at offset {}, the index begins at {}",
                                               expected_offset, dump.footer.index_offset)});
  }
  return {};
}

// Step 8.
Result<void> read_preamble(OpenDump& dump) {
  for (size_t i = 0; i < dump.entries.size(); ++i) {
    const IndexEntry& entry = dump.entries[i];
    const bool in_place = (i == 0) == entry.header.is(kTypeImag) &&
                          (i == 1) == entry.header.is(kTypeChan) && !entry.header.is(kTypeIndx);
    if (!in_place) {
      return refuse_record(dump, entry, {kDamaged, "records are not IMAG, CHAN, ..., INDX"});
    }
  }
  if (const auto sizes = check_preamble_sizes(dump.entries[0].header, dump.entries[1].header);
      !sizes) {
    return refuse(dump, sizes.error());
  }
  SPOOL_ASSIGN(const auto imag, read_payload(dump.file, dump.entries[0]));
  SPOOL_ASSIGN(const auto chan, read_payload(dump.file, dump.entries[1]));
  auto header = parse_dump_header(imag, chan, dump.file_header);
  if (!header) return refuse(dump, header.error());
  dump.header = std::move(*header);
  dump.geometry = DumpGeometry(dump.header);
  return {};
}

// Step 9.
Result<void> place_blocks(OpenDump& dump) {
  dump.record_of_slot.assign(dump.geometry.slot_count(), kNoRecord);
  uint64_t data_records = 0;
  uint64_t meta_records = 0;
  for (size_t i = 2; i < dump.entries.size(); ++i) {
    const IndexEntry& entry = dump.entries[i];
    if (entry.header.is(kTypeMeta) &&
        (++meta_records > kMaxMetaRecords || entry.header.raw_bytes < kMinMetaBytes ||
         entry.header.raw_bytes > kMaxMetaBytes)) {
      return refuse_record(dump, entry, {kDamaged, "meta record outside the limits"});
    }
    if (!entry.header.is(kTypeData)) continue;
    const auto block = check_data_record(entry.header, dump.geometry);
    if (!block) return refuse_record(dump, entry, block.error());
    uint32_t& record =
        dump.record_of_slot[*dump.geometry.slot(entry.header.group, entry.header.tile, *block)];
    if (record != kNoRecord) return refuse_record(dump, entry, {kDamaged, "block occurs twice"});
    record = static_cast<uint32_t>(i);
    ++data_records;
  }
  if (data_records != dump.footer.data_record_count) {
    return refuse(dump, {kDamaged, fmt::format("footer counts {} DATA records, there are {}",
                                               dump.footer.data_record_count, data_records)});
  }
  dump.missing_blocks = static_cast<uint32_t>(dump.geometry.slot_count() - data_records);
  if (((dump.footer.flags & kFlagComplete) != 0) != (dump.missing_blocks == 0)) {
    return refuse(dump, {kDamaged, fmt::format("footer flag `complete` is wrong: absent blocks: {}",
                                               dump.missing_blocks)});
  }
  return {};
}

// Step 10.
Result<void> read_meta(OpenDump& dump) {
  for (const IndexEntry& entry : dump.entries) {
    if (!entry.header.is(kTypeMeta)) continue;
    SPOOL_ASSIGN(const auto payload, read_payload(dump.file, entry));
    std::string text(reinterpret_cast<const char*>(payload.data()), payload.size());
    if (const auto valid = check_meta(text); !valid) {
      return refuse_record(dump, entry, valid.error());
    }
    dump.meta.push_back(std::move(text));
  }
  return {};
}

}  // namespace

Result<OpenDump> open_dump(const std::filesystem::path& path) {
  OpenDump dump;
  SPOOL_ASSIGN(dump.file, FileHandle::open(path, OpenMode::kRead));
  SPOOL_ASSIGN(dump.file_bytes, dump.file.size());
  SPOOL_TRY(read_file_header(dump));
  SPOOL_TRY(read_footer(dump));
  SPOOL_ASSIGN(const auto index, read_index(dump));
  SPOOL_TRY(walk_records(dump, index));
  SPOOL_TRY(read_preamble(dump));
  SPOOL_TRY(place_blocks(dump));
  SPOOL_TRY(read_meta(dump));
  return dump;
}

Result<void> read_payload_into(const FileHandle& file, const IndexEntry& entry,
                               std::span<std::byte> bytes) {
  const auto stored = static_cast<size_t>(entry.header.stored_bytes);
  SPOOL_TRY(file.read_at(entry.offset + kUnit, bytes));
  const auto damage = [&](std::string_view what) {
    return tl::unexpected(
        file_error(file.path(),
                   {kDamaged, fmt::format("{} ({})", what, describe(entry.header, entry.offset))}));
  };
  if (crc32(bytes.first(stored)) != entry.header.payload_crc32) {
    return damage("payload does not match its checksum");
  }
  if (!is_zero_pad(bytes.subspan(stored))) return damage("pad bytes are not 0");
  return {};
}

Result<std::vector<std::byte>> read_payload(const FileHandle& file, const IndexEntry& entry,
                                            bool with_pad) {
  const auto stored = static_cast<size_t>(entry.header.stored_bytes);
  std::vector<std::byte> bytes(with_pad ? *checked_pad64(stored) : stored);
  SPOOL_TRY(read_payload_into(file, entry, bytes));
  bytes.resize(stored);
  return bytes;
}

Judged<std::vector<std::byte>> decode_block(const RecordHeader& record,
                                            const DumpGeometry& geometry,
                                            std::vector<std::byte> stored) {
  if (record.codec == static_cast<uint8_t>(Codec::kNone)) return stored;
  std::vector<std::byte> plain(static_cast<size_t>(record.raw_bytes));
  SPOOL_JUDGE(decode_payload(static_cast<Codec>(record.codec), static_cast<Filter>(record.filter),
                             stored, bytes_per_value(geometry.groups()[record.group].type), plain));
  return plain;
}

}  // namespace spool::format
