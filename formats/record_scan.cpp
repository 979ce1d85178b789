#include "formats/record_scan.h"

#include <algorithm>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/geometry_rules.h"
#include "formats/header_rules.h"
#include "formats/open_dump.h"

namespace spool::format {

namespace {

using enum FailureClass;

constexpr uint64_t kWindowBytes = uint64_t{1} << 20;

// A file made to hurt can hold many intact headers whose payloads overlap and all fail. After this
// many times its size has been read, a failed payload is stepped over as a whole.
constexpr uint64_t kRescanFactor = 16;

uint64_t last_unit_before(uint64_t end) {
  return end / kUnit * kUnit;
}

// First offset >= `from`, a multiple of 64, that holds a sync word; file_bytes if there is none.
uint64_t find_sync(const FileHandle& file, uint64_t from, uint64_t file_bytes) {
  std::vector<std::byte> window;
  while (fits(from, kUnit, file_bytes)) {
    window.resize(std::min(kWindowBytes, last_unit_before(file_bytes - from)));
    if (!file.read_at(from, window)) {
      from += window.size();  // unreadable: a hole in the disk
      continue;
    }
    for (size_t at = 0; at < window.size(); at += kUnit) {
      if (load<std::array<uint8_t, 4>>(window, at) == kSyncBytes) return from + at;
    }
    from += window.size();
  }
  return file_bytes;
}

// The recording id of most use when the file header is gone: that of the first intact record
// header.
std::optional<uint64_t> find_dump_id(const FileHandle& file, uint64_t file_bytes) {
  for (uint64_t at = find_sync(file, 0, file_bytes); at < file_bytes;
       at = find_sync(file, at + kUnit, file_bytes)) {
    UnitBytes bytes{};
    if (!file.read_at(at, bytes)) continue;
    const auto header = check_record_bytes(bytes);
    if (header && check_record_alone(*header, header->dump_id)) return header->dump_id;
  }
  return std::nullopt;
}

Result<FileHeader> find_file_header(const FileHandle& file, RecordScan& scan) {
  UnitBytes bytes{};
  const auto first = std::span(bytes).first(std::min<uint64_t>(scan.file_bytes, kUnit));
  SPOOL_TRY(file.read_at(0, first));
  const auto header = check_file_header(first);
  if (header) return *header;
  if (header.error().failure == kUnsupported || header.error().failure == kInvalid) {
    return tl::unexpected(file_error(file.path(), header.error()));
  }
  const auto dump_id = find_dump_id(file, scan.file_bytes);
  if (!dump_id) return tl::unexpected(file_error(file.path(), header.error()));
  scan.damaged.push_back({"header", std::nullopt, 0, header.error().what});
  scan.header_intact = false;
  FileHeader rebuilt;
  if (first.size() == kUnit) rebuilt.dump_uuid = decode_file_header(first).dump_uuid;
  store(std::as_writable_bytes(std::span(rebuilt.dump_uuid)), 0, *dump_id);
  return rebuilt;
}

struct Finding {
  IndexEntry entry;
  bool known = false;  // header intact
  std::string reason;  // empty: the record is intact
};

Finding examine(const FileHandle& file, uint64_t at, const RecordScan& scan) {
  Finding finding;
  finding.entry.offset = at;
  UnitBytes bytes{};
  if (const auto read = file.read_at(at, bytes); !read) {
    finding.reason = "cannot be read";
    return finding;
  }
  const auto header = check_record_bytes(bytes);
  if (!header) {
    finding.reason = header.error().what;
    return finding;
  }
  finding.entry.header = *header;
  if (const auto alone = check_record_alone(*header, scan.file_header.dump_id()); !alone) {
    finding.reason = alone.error().what;
    return finding;
  }
  finding.known = true;
  const uint64_t payload = *checked_pad64(header->stored_bytes);
  if (!fits(at + kUnit, payload, scan.file_bytes)) {
    finding.reason = "the file ends within the payload";
  } else if (!read_payload(file, finding.entry, true)) {
    finding.reason = "payload or pad bytes do not match";
  }
  return finding;
}

bool has_footer(const FileHandle& file, const RecordScan& scan) {
  UnitBytes bytes{};
  return scan.file_bytes >= 2 * kUnit && file.read_at(scan.file_bytes - kUnit, bytes).has_value() &&
         check_footer(bytes, scan.file_header, scan.file_bytes).has_value();
}

void note_damage(RecordScan& scan, const Finding& finding) {
  const RecordHeader& header = finding.entry.header;
  DamagedRecord damage{"?", std::nullopt, finding.entry.offset, finding.reason};
  if (finding.known) {
    damage.type = header.type_name();
    damage.sequence = header.sequence;
    if (header.is(kTypeData)) {
      damage.block = BlockKey{header.group, header.tile, header.sample_begin, header.sample_count};
    }
  }
  scan.damaged.push_back(std::move(damage));
}

}  // namespace

Result<RecordScan> scan_records(const FileHandle& file) {
  RecordScan scan;
  SPOOL_ASSIGN(scan.file_bytes, file.size());
  SPOOL_ASSIGN(scan.file_header, find_file_header(file, scan));
  scan.footer_intact = has_footer(file, scan);
  const uint64_t end = scan.file_bytes - (scan.footer_intact ? kUnit : 0);
  const uint64_t budget = file.bytes_read() + kRescanFactor * scan.file_bytes;
  uint64_t at = kUnit;
  bool whole = true;
  while (fits(at, 1, end)) {
    Finding finding =
        fits(at, kUnit, end) ? examine(file, at, scan) : Finding{{at, {}}, false, "cut"};
    const uint64_t extent =
        finding.known ? kUnit + *checked_pad64(finding.entry.header.stored_bytes) : kUnit;
    if (finding.reason.empty()) {
      scan.intact.push_back(finding.entry);
      at += extent;
      if (whole) scan.whole_until = at;
      continue;
    }
    whole = false;
    note_damage(scan, finding);
    at = find_sync(file, at + (file.bytes_read() > budget ? extent : kUnit), end);
  }
  if (!scan.footer_intact) {
    scan.damaged.push_back(
        {"footer", std::nullopt, scan.file_bytes, "no intact footer at the end"});
  }
  return scan;
}

Result<DumpHeader> header_of_scan(const FileHandle& file, const RecordScan& scan) {
  const auto find = [&](std::string_view type) {
    return std::ranges::find_if(scan.intact,
                                [&](const IndexEntry& entry) { return entry.header.is(type); });
  };
  const auto imag = find(kTypeImag);
  const auto chan = find(kTypeChan);
  if (imag == scan.intact.end() || chan == scan.intact.end()) {
    return fail(ErrorCode::kDamage,
                "{}: the {} record is lost, without it samples have no meaning: record again",
                file.path().string(), imag == scan.intact.end() ? kTypeImag : kTypeChan);
  }
  if (const auto sizes = check_preamble_sizes(imag->header, chan->header); !sizes) {
    return tl::unexpected(file_error(file.path(), sizes.error()));
  }
  SPOOL_ASSIGN(const auto imag_bytes, read_payload(file, *imag));
  SPOOL_ASSIGN(const auto chan_bytes, read_payload(file, *chan));
  auto header = parse_dump_header(imag_bytes, chan_bytes, scan.file_header);
  if (!header) return tl::unexpected(file_error(file.path(), header.error()));
  return *header;
}

}  // namespace spool::format
