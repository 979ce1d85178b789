#include "formats/spool_writer.h"

#include <sys/random.h>

#include <vector>

#include "formats/chunk_codec.h"
#include "formats/dump_geometry.h"
#include "formats/geometry_rules.h"
#include "formats/header_rules.h"
#include "formats/meta_rules.h"
#include "formats/record_scan.h"
#include "formats/record_writer.h"

namespace spool::format {

namespace {

Result<std::array<uint8_t, 16>> random_uuid(const std::filesystem::path& path) {
  std::array<uint8_t, 16> uuid{};
  if (::getrandom(uuid.data(), uuid.size(), 0) != static_cast<ssize_t>(uuid.size())) {
    return fail(ErrorCode::kIo, "{}: the system gives no random bytes: pass a uuid", path.string());
  }
  return uuid;
}

}  // namespace

struct SpoolWriter::State {
  RecordWriter records;
  bool compress = false;
  DumpHeader header;
  DumpGeometry geometry;
  std::vector<bool> written;  // by slot
  uint64_t data_records = 0;
  uint32_t meta_records = 0;
  bool finished = false;

  State(const DumpHeader& dump_header, bool compress_blocks)
      : compress(compress_blocks),
        header(dump_header),
        geometry(dump_header),
        written(geometry.slot_count()) {}

  std::string name() const { return records.path().string(); }

  Result<void> check_running() const {
    if (!finished) return {};
    return fail(ErrorCode::kUsage, "{}: the recording is finished: open a new writer", name());
  }

  Result<void> write_preamble() {
    SPOOL_TRY(records.append_plain(kTypeImag, encode_imag(header)));
    std::vector<std::byte> channels;
    for (const ChannelInfo& channel : header.channels) {
      const UnitBytes entry = encode_channel(channel);
      channels.insert(channels.end(), entry.begin(), entry.end());
    }
    return records.append_plain(kTypeChan, channels);
  }

  // Takes the records of a partial file as if they had been written now.
  Result<void> adopt(const std::vector<IndexEntry>& entries, const std::filesystem::path& file) {
    for (size_t i = 0; i < entries.size(); ++i) {
      const RecordHeader& record = entries[i].header;
      const auto refuse = [&](std::string_view what) {
        return tl::unexpected(
            file_error(file, {FailureClass::kDamaged,
                              fmt::format("{} ({})", what, describe(record, entries[i].offset))}));
      };
      const bool in_place = record.sequence == i && (i == 0) == record.is(kTypeImag) &&
                            (i == 1) == record.is(kTypeChan);
      if (!in_place) return refuse("records are out of order");
      if (record.is(kTypeMeta) && ++meta_records > kMaxMetaRecords) {
        return refuse("too many meta records");
      }
      if (!record.is(kTypeData)) continue;
      const auto block = check_data_record(record, geometry);
      if (!block) return refuse(block.error().what);
      const uint32_t slot = *geometry.slot(record.group, record.tile, *block);
      if (written[slot]) return refuse("block occurs twice");
      written[slot] = true;
      ++data_records;
    }
    return {};
  }
};

SpoolWriter::SpoolWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SpoolWriter::SpoolWriter(SpoolWriter&&) noexcept = default;
SpoolWriter& SpoolWriter::operator=(SpoolWriter&&) noexcept = default;
SpoolWriter::~SpoolWriter() = default;

Result<SpoolWriter> SpoolWriter::create(const std::filesystem::path& path, const DumpHeader& header,
                                        const WriterOptions& options) {
  if (const auto valid = check_dump_header(header); !valid) {
    return fail(ErrorCode::kUsage, "{}: {}: see formats/spool.md for the limits", path.string(),
                valid.error().what);
  }
  auto state = std::make_unique<State>(header, options.compress);
  if (options.uuid) {
    state->header.uuid = *options.uuid;
  } else {
    SPOOL_ASSIGN(state->header.uuid, random_uuid(path));
  }
  FileHeader file_header;
  file_header.dump_uuid = state->header.uuid;
  SPOOL_ASSIGN(state->records,
               RecordWriter::create(path, file_header, options.force, options.discard_unfinished));
  state->records.sync_every(options.sync_every_bytes);
  SPOOL_TRY(state->write_preamble());
  return SpoolWriter(std::move(state));
}

Result<SpoolWriter> SpoolWriter::resume(const std::filesystem::path& path,
                                        const WriterOptions& options) {
  const std::filesystem::path partial = partial_name(path);
  SPOOL_ASSIGN(FileHandle file, FileHandle::open(partial, OpenMode::kAppend));
  SPOOL_TRY(file.lock());
  SPOOL_ASSIGN(const bool named, file.is_named(partial));
  if (!named) {
    return fail(ErrorCode::kIo, "{}: its writer has just finished it", partial.string());
  }
  SPOOL_ASSIGN(RecordScan scan, scan_records(file));
  if (scan.file_header.minor > kMinorVersion) {
    return fail(ErrorCode::kData,
                "{}: format version {}.{}: resume it with the program that wrote it",
                partial.string(), scan.file_header.major, scan.file_header.minor);
  }
  const bool torn_tail_only =
      scan.header_intact && !scan.intact.empty() && scan.intact.back().offset < scan.whole_until;
  if (!torn_tail_only) {
    return fail(ErrorCode::kDamage,
                "{}: damaged before its end, not just unfinished: run `spool recover`",
                partial.string());
  }
  SPOOL_ASSIGN(const DumpHeader header, header_of_scan(file, scan));
  // Sealed already, but not renamed: the index is written again at the end.
  if (scan.intact.back().header.is(kTypeIndx)) {
    scan.whole_until = scan.intact.back().offset;
    scan.intact.pop_back();
  }
  auto state = std::make_unique<State>(header, options.compress);
  SPOOL_TRY(state->adopt(scan.intact, partial));
  SPOOL_ASSIGN(state->records,
               RecordWriter::resume(path, std::move(file), scan.file_header, std::move(scan.intact),
                                    scan.whole_until, options.force));
  state->records.sync_every(options.sync_every_bytes);
  return SpoolWriter(std::move(state));
}

const DumpHeader& SpoolWriter::header() const {
  return state_->header;
}

bool SpoolWriter::has_block(uint16_t group, uint32_t tile, uint32_t block) const {
  const auto slot = state_->geometry.slot(group, tile, block);
  return slot && state_->written[*slot];
}

uint32_t SpoolWriter::meta_count() const {
  return state_->meta_records;
}

Result<void> SpoolWriter::write_meta(std::string_view json) {
  State& state = *state_;
  SPOOL_TRY(state.check_running());
  if (const auto valid = check_meta(json); !valid) {
    return fail(ErrorCode::kUsage, "{}: {}: give one JSON object", state.name(),
                valid.error().what);
  }
  if (state.meta_records == kMaxMetaRecords) {
    return fail(ErrorCode::kUsage, "{}: more than {} meta records: join them", state.name(),
                kMaxMetaRecords);
  }
  SPOOL_TRY(state.records.append_plain(kTypeMeta, std::as_bytes(std::span(json))));
  ++state.meta_records;
  return {};
}

Result<void> SpoolWriter::write_block(uint16_t group, uint32_t tile, uint32_t sample_begin,
                                      uint32_t sample_count, std::span<const std::byte> payload) {
  State& state = *state_;
  SPOOL_TRY(state.check_running());
  RecordHeader record;
  record.type = record_type(kTypeData);
  record.raw_bytes = payload.size();
  record.group = group;
  record.tile = tile;
  record.sample_begin = sample_begin;
  record.sample_count = sample_count;
  const auto block = check_data_record(record, state.geometry);
  if (!block) {
    return fail(ErrorCode::kUsage,
                "{}: {} (group {} tile {} samples {}+{}): see formats/spool.md 4.3", state.name(),
                block.error().what, group, tile, sample_begin, sample_count);
  }
  const uint32_t slot = *state.geometry.slot(group, tile, *block);
  if (state.written[slot]) {
    return fail(ErrorCode::kUsage,
                "{}: block was written before (group {} tile {} samples {}+{}): write it once",
                state.name(), group, tile, sample_begin, sample_count);
  }
  std::optional<std::vector<std::byte>> packed;
  if (state.compress) {
    packed = compress_payload(payload, bytes_per_value(state.geometry.groups()[group].type));
  }
  if (packed) {
    record.codec = static_cast<uint8_t>(Codec::kZstd);
    record.filter = static_cast<uint8_t>(Filter::kByteShuffle);
  }
  SPOOL_TRY(state.records.append(record, packed ? std::span<const std::byte>(*packed) : payload));
  state.written[slot] = true;
  ++state.data_records;
  return {};
}

Result<void> SpoolWriter::finish() {
  State& state = *state_;
  SPOOL_TRY(state.check_running());
  const bool complete = state.data_records == state.geometry.slot_count();
  SPOOL_TRY(state.records.seal(state.data_records, complete ? kFlagComplete : 0));
  state.finished = true;
  return state.records.publish();
}

}  // namespace spool::format
