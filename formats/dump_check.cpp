#include "formats/dump_check.h"

#include "formats/dump_geometry.h"
#include "formats/header_rules.h"
#include "formats/open_dump.h"

namespace spool::format {

namespace {

std::optional<BlockKey> key_of(const RecordHeader& header) {
  if (!header.is(kTypeData)) return std::nullopt;
  return BlockKey{header.group, header.tile, header.sample_begin, header.sample_count};
}

std::vector<BlockKey> missing_blocks(const DumpGeometry& geometry, const std::vector<bool>& found) {
  std::vector<BlockKey> missing;
  const auto groups = static_cast<uint16_t>(geometry.groups().size());  // at most 16
  for (uint16_t group = 0; group < groups; ++group) {
    const GroupLayout& layout = geometry.groups()[group];
    for (uint32_t tile = 0; tile < layout.tiles; ++tile) {
      for (uint32_t block = 0; block < layout.blocks; ++block) {
        if (found[*geometry.slot(group, tile, block)]) continue;
        missing.push_back(
            {group, tile, geometry.block_begin(group, block), geometry.block_count(group, block)});
      }
    }
  }
  return missing;
}

void mark_found(const IndexEntry& entry, const DumpGeometry& geometry, std::vector<bool>& found) {
  if (const auto block = check_data_record(entry.header, geometry)) {
    found[*geometry.slot(entry.header.group, entry.header.tile, *block)] = true;
  }
}

// What is wrong with a record whose header is intact; empty if nothing.
std::string record_damage(const FileHandle& file, const DumpGeometry& geometry,
                          const IndexEntry& entry) {
  if (entry.header.is(kTypeData)) {
    // Comes first: the geometry bounds what decoding may allocate.
    if (const auto fits = check_data_record(entry.header, geometry); !fits) {
      return fits.error().what;
    }
  }
  auto stored = read_payload(file, entry, true);
  if (!stored) return "payload or pad bytes do not match";
  if (!entry.header.is(kTypeData)) return {};
  const auto plain = decode_block(entry.header, geometry, std::move(*stored));
  return plain ? std::string() : plain.error().what;
}

CheckReport check_open(const OpenDump& dump) {
  CheckReport report;
  report.opens = true;
  report.bytes = dump.file_bytes;
  report.records = 1;  // INDX: its payload and pad were verified at opening
  std::vector<bool> found(dump.geometry.slot_count());
  for (const IndexEntry& entry : dump.entries) {
    std::string reason = record_damage(dump.file, dump.geometry, entry);
    if (!reason.empty()) {
      report.damaged.push_back({std::string(entry.header.type_name()), key_of(entry.header),
                                entry.offset, std::move(reason)});
      continue;
    }
    ++report.records;
    if (entry.header.is(kTypeData)) mark_found(entry, dump.geometry, found);
  }
  report.missing = missing_blocks(dump.geometry, found);
  report.complete = report.damaged.empty() && report.missing.empty();
  return report;
}

Result<CheckReport> check_closed(const std::filesystem::path& path, const Error& open_error) {
  SPOOL_ASSIGN(const FileHandle file, FileHandle::open(path, OpenMode::kRead));
  CheckReport report;
  report.open_error = open_error.message;
  SPOOL_ASSIGN(report.bytes, file.size());
  auto scan = scan_records(file);
  if (!scan && scan.error().code != ErrorCode::kDamage) return tl::unexpected(scan.error());
  if (!scan) {
    report.damaged.push_back({"header", std::nullopt, 0, scan.error().message});
    return report;
  }
  report.damaged = std::move(scan->damaged);
  report.records = scan->intact.size();
  if (const auto header = header_of_scan(file, *scan)) {
    const DumpGeometry geometry(*header);
    std::vector<bool> found(geometry.slot_count());
    for (const IndexEntry& entry : scan->intact) {
      if (!entry.header.is(kTypeData)) continue;
      if (const std::string reason = record_damage(file, geometry, entry); !reason.empty()) {
        report.damaged.push_back({"DATA", key_of(entry.header), entry.offset, reason});
        --report.records;
        continue;
      }
      mark_found(entry, geometry, found);
    }
    report.missing = missing_blocks(geometry, found);
  } else {
    report.damaged.push_back({"IMAG", std::nullopt, kUnit, header.error().message});
  }
  if (report.damaged.empty()) {
    // Every record is sound but they do not make one file: order, index or footer are wrong.
    report.damaged.push_back({"file", std::nullopt, 0, open_error.message});
  }
  return report;
}

}  // namespace

Result<CheckReport> check_dump(const std::filesystem::path& path) {
  const auto dump = open_dump(path);
  if (dump) return check_open(*dump);
  if (dump.error().code != ErrorCode::kDamage) return tl::unexpected(dump.error());
  return check_closed(path, dump.error());
}

}  // namespace spool::format
