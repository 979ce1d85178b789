#include "formats/spool_recovery.h"

#include <algorithm>
#include <set>

#include "formats/dump_geometry.h"
#include "formats/header_rules.h"
#include "formats/meta_rules.h"
#include "formats/open_dump.h"
#include "formats/record_scan.h"
#include "formats/record_writer.h"
#include "formats/target_watch.h"

namespace spool::format {

namespace {

BlockKey key_of(const RecordHeader& record) {
  return {record.group, record.tile, record.sample_begin, record.sample_count};
}

struct Rescue {
  FileHandle file;
  RecordScan scan;
  DumpGeometry geometry;
  std::vector<bool> found;       // by slot
  std::set<uint64_t> sequences;  // of the records kept
  uint32_t meta_records = 0;
  RecoveryReport report;
};

// Why an intact record is not kept; empty if it is. Marks a block as found.
std::string objection(Rescue& rescue, const RecordHeader& record,
                      std::span<const std::byte> stored) {
  if (record.is(kTypeMeta)) {
    const std::string_view text(reinterpret_cast<const char*>(stored.data()), stored.size());
    if (const auto valid = check_meta(text); !valid) return valid.error().what;
    return ++rescue.meta_records > kMaxMetaRecords ? "too many meta records" : "";
  }
  if (!record.is(kTypeData)) return is_ancillary(record) ? "" : "a second record of its kind";
  const auto block = check_data_record(record, rescue.geometry);
  if (!block) return block.error().what;
  const auto plain =
      decode_block(record, rescue.geometry, std::vector<std::byte>(stored.begin(), stored.end()));
  if (!plain) return plain.error().what;
  const uint32_t slot = *rescue.geometry.slot(record.group, record.tile, *block);
  if (rescue.found[slot]) return "block occurs twice";
  rescue.found[slot] = true;
  return {};
}

Result<void> keep(Rescue& rescue, RecordWriter& writer, const IndexEntry& entry,
                  std::span<const std::byte> stored) {
  SPOOL_TRY(writer.append(entry.header, stored));
  rescue.sequences.insert(entry.header.sequence);
  ++rescue.report.kept_records;
  if (entry.header.is(kTypeData)) ++rescue.report.kept_blocks;
  return {};
}

Result<void> copy_records(Rescue& rescue, RecordWriter& writer) {
  const auto& intact = rescue.scan.intact;
  std::set<uint64_t> preamble;  // offsets
  for (std::string_view type : {kTypeImag, kTypeChan}) {
    const auto entry = std::ranges::find_if(
        intact, [&](const IndexEntry& candidate) { return candidate.header.is(type); });
    SPOOL_ASSIGN(const auto stored, read_payload(rescue.file, *entry));
    SPOOL_TRY(keep(rescue, writer, *entry, stored));
    preamble.insert(entry->offset);
  }
  for (const IndexEntry& entry : intact) {
    if (entry.header.is(kTypeIndx) || preamble.contains(entry.offset)) continue;
    SPOOL_ASSIGN(const auto stored, read_payload(rescue.file, entry));
    std::string reason = objection(rescue, entry.header, stored);
    if (reason.empty()) {
      SPOOL_TRY(keep(rescue, writer, entry, stored));
      continue;
    }
    DamagedRecord damage{std::string(entry.header.type_name()), std::nullopt, entry.offset,
                         std::move(reason)};
    if (entry.header.is(kTypeData)) damage.block = key_of(entry.header);
    damage.sequence = entry.header.sequence;
    rescue.report.damaged.push_back(std::move(damage));
  }
  return {};
}

// Records that the old index names, if it is intact: the surest list of what was there.
Result<std::vector<IndexEntry>> indexed_records(const Rescue& rescue) {
  std::vector<IndexEntry> entries;
  for (const IndexEntry& entry : rescue.scan.intact) {
    if (!entry.header.is(kTypeIndx)) continue;
    SPOOL_ASSIGN(const auto index, read_payload(rescue.file, entry));
    for (size_t at = 0; at + kUnit <= index.size(); at += kUnit) {
      entries.push_back(decode_index_entry(std::span(index).subspan(at, kUnit)));
    }
    break;
  }
  return entries;
}

// A block counts as lost when a damaged record or the old index names it and it was not kept.
void list_losses(Rescue& rescue, const std::vector<IndexEntry>& indexed) {
  rescue.report.has_index = !indexed.empty();
  const DumpGeometry& geometry = rescue.geometry;
  std::vector<bool> named(geometry.slot_count());
  const auto name = [&](const BlockKey& key) {
    const auto block = geometry.block_of(key.group, key.sample_begin);
    if (const auto slot = block ? geometry.slot(key.group, key.tile, *block) : std::nullopt) {
      named[*slot] = true;
    }
  };
  std::set<uint64_t> known = rescue.sequences;
  for (const DamagedRecord& damage : rescue.report.damaged) {
    if (damage.block) name(*damage.block);
    if (damage.sequence && damage.type != kTypeIndx) known.insert(*damage.sequence);
  }
  for (const IndexEntry& entry : indexed) {
    if (entry.header.is(kTypeData)) name(key_of(entry.header));
    known.insert(entry.header.sequence);
  }
  const auto groups = static_cast<uint16_t>(geometry.groups().size());  // at most 16
  for (uint16_t group = 0; group < groups; ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        const uint32_t slot = *geometry.slot(group, tile, block);
        if (rescue.found[slot]) continue;
        const BlockKey key = {group, tile, geometry.block_begin(group, block),
                              geometry.block_count(group, block)};
        (named[slot] ? rescue.report.lost : rescue.report.absent).push_back(key);
      }
    }
  }
  const uint64_t written = known.empty() ? 0 : *known.rbegin() + 1;
  const uint64_t gaps = written - rescue.sequences.size();
  // Unclaimed bytes at the end may have been a record, unless the index says otherwise.
  const bool torn_tail = indexed.empty() && std::ranges::any_of(rescue.report.damaged,
                                                                [](const DamagedRecord& damage) {
                                                                  return damage.type == "?";
                                                                });
  rescue.report.lost_records =
      std::max<uint64_t>({gaps, rescue.report.lost.size(), torn_tail ? 1u : 0u});
}

Result<void> write_output(Rescue& rescue, RecordWriter& writer) {
  SPOOL_TRY(copy_records(rescue, writer));
  SPOOL_ASSIGN(const auto indexed, indexed_records(rescue));
  list_losses(rescue, indexed);
  const bool complete = rescue.report.kept_blocks == rescue.geometry.slot_count();
  SPOOL_TRY(writer.seal(rescue.report.kept_blocks, complete ? kFlagComplete : 0));
  SPOOL_ASSIGN(const CheckReport check, check_dump(writer.partial()));
  if (check.intact()) return {};
  return fail(ErrorCode::kIo, "{}: the recovered file does not check ({}): is the disk sound?",
              writer.partial().string(),
              check.damaged.empty() ? check.open_error : check.damaged.front().reason);
}

}  // namespace

Result<RecoveryReport> recover_dump(const std::filesystem::path& input,
                                    const std::filesystem::path& output, bool force) {
  for (const auto& name : {output, partial_name(output), partial_name(output, true)})
    SPOOL_TRY(refuse_own_input(name, input));
  Rescue rescue;
  SPOOL_ASSIGN(rescue.file, FileHandle::open(input, OpenMode::kRead));
  SPOOL_ASSIGN(rescue.scan, scan_records(rescue.file));
  if (rescue.scan.file_header.minor > kMinorVersion) {
    return fail(ErrorCode::kData, "{}: format version {}.{}: recover it with a newer spool",
                input.string(), rescue.scan.file_header.major, rescue.scan.file_header.minor);
  }
  SPOOL_ASSIGN(const DumpHeader header, header_of_scan(rescue.file, rescue.scan));
  rescue.geometry = DumpGeometry(header);
  rescue.found.resize(rescue.geometry.slot_count());
  rescue.report.damaged = rescue.scan.damaged;
  // What is begun is only a copy, and would stand in the way of the next try: discarded.
  SPOOL_ASSIGN(RecordWriter writer,
               RecordWriter::create(output, rescue.scan.file_header, force, true));
  SPOOL_TRY(write_output(rescue, writer));
  SPOOL_TRY(writer.publish());
  return std::move(rescue.report);
}

}  // namespace spool::format
