#include "formats/spool_writer.h"

#include <sys/random.h>

#include <chrono>
#include <cstring>
#include <vector>

#include "formats/checked_math.h"
#include "formats/chunk_codec.h"
#include "formats/crc32.h"
#include "formats/dump_geometry.h"
#include "formats/file_handle.h"
#include "formats/header_rules.h"
#include "formats/meta_rules.h"

namespace spool::format {

namespace {

// How much a power failure may cost.
constexpr uint64_t kSyncBytes256M = uint64_t{256} << 20;
constexpr std::chrono::seconds kSyncInterval{30};

Result<std::array<uint8_t, 16>> random_uuid(const std::filesystem::path& path) {
  std::array<uint8_t, 16> uuid{};
  if (::getrandom(uuid.data(), uuid.size(), 0) != static_cast<ssize_t>(uuid.size())) {
    return fail(ErrorCode::kIo, "{}: the system gives no random bytes: pass a uuid", path.string());
  }
  return uuid;
}

std::filesystem::path partial_name(const std::filesystem::path& path) {
  std::filesystem::path partial = path;
  partial += ".partial";
  return partial;
}

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

Result<FileHandle> open_partial(const std::filesystem::path& partial, bool force) {
  if (!is_there(partial)) {
    SPOOL_ASSIGN(FileHandle file, FileHandle::open(partial, OpenMode::kCreate));
    SPOOL_TRY(file.lock());
    return file;
  }
  if (!force) {
    return fail(ErrorCode::kUsage,
                "{}: an unfinished dump is there: `spool recover` it, delete it or use --force",
                partial.string());
  }
  SPOOL_ASSIGN(FileHandle file, FileHandle::open(partial, OpenMode::kAppend));
  SPOOL_TRY(file.size());
  SPOOL_TRY(file.lock());
  SPOOL_TRY(file.truncate(0));
  return file;
}

}  // namespace

struct SpoolWriter::State {
  std::filesystem::path path;
  WriterOptions options;
  DumpHeader header;
  DumpGeometry geometry;
  FileHandle file;
  FileHeader file_header;
  std::vector<IndexEntry> entries;
  std::vector<bool> written;  // by slot
  std::vector<std::byte> buffer;
  uint64_t end = 0;  // of the last whole record
  uint64_t data_records = 0;
  uint32_t meta_records = 0;
  bool stopped = false;  // finished or failed
  uint64_t synced_until = 0;
  std::chrono::steady_clock::time_point synced_at = std::chrono::steady_clock::now();

  Result<void> check_running() const {
    if (!stopped) return {};
    return fail(ErrorCode::kUsage, "{}: the writer has stopped: open a new one", path.string());
  }

  // Cuts a torn record off. If that fails too, the torn record is what recovery skips.
  Result<void> stop_after(Error error) {
    stopped = true;
    static_cast<void>(file.truncate(end));
    return tl::unexpected(std::move(error));
  }

  Result<void> sync() {
    if (auto synced = file.sync(); !synced) {
      stopped = true;  // a failed fsync is final
      return synced;
    }
    synced_until = end;
    synced_at = std::chrono::steady_clock::now();
    return {};
  }

  void build_record(RecordHeader& record, std::span<const std::byte> stored) {
    record.sequence = entries.size();
    record.dump_id = file_header.dump_id();
    record.stored_bytes = stored.size();
    record.payload_crc32 = crc32(stored);
    const UnitBytes head = encode(record);
    buffer.assign(kUnit + *checked_pad64(stored.size()), std::byte{0});
    std::memcpy(buffer.data(), head.data(), kUnit);
    std::memcpy(buffer.data() + kUnit, stored.data(), stored.size());
  }

  Result<void> append(RecordHeader record, std::span<const std::byte> stored) {
    if (entries.size() + 2 > kMaxRecords) {
      return fail(ErrorCode::kUsage, "{}: more than {} records", path.string(), kMaxRecords);
    }
    build_record(record, stored);
    if (auto put = file.write_at(end, buffer); !put) return stop_after(std::move(put).error());
    entries.push_back({end, record});
    end += buffer.size();
    const bool due = end - synced_until >= kSyncBytes256M ||
                     std::chrono::steady_clock::now() - synced_at >= kSyncInterval;
    if (due) return sync();
    return {};
  }

  Result<void> append_plain(std::string_view type, std::span<const std::byte> payload) {
    RecordHeader record;
    record.type = record_type(type);
    record.raw_bytes = payload.size();
    return append(record, payload);
  }

  Result<void> write_preamble() {
    const UnitBytes head = encode(file_header);
    if (auto put = file.write_at(0, head); !put) return stop_after(std::move(put).error());
    end = kUnit;
    SPOOL_TRY(append_plain(kTypeImag, encode_imag(header)));
    std::vector<std::byte> channels;
    for (const ChannelInfo& channel : header.channels) {
      const UnitBytes entry = encode_channel(channel);
      channels.insert(channels.end(), entry.begin(), entry.end());
    }
    return append_plain(kTypeChan, channels);
  }

  Result<void> write_index_and_footer() {
    std::vector<std::byte> index;
    index.reserve(entries.size() * kUnit);
    for (const IndexEntry& entry : entries) {
      const UnitBytes bytes = encode(entry);
      index.insert(index.end(), bytes.begin(), bytes.end());
    }
    RecordHeader record;
    record.type = record_type(kTypeIndx);
    record.raw_bytes = index.size();
    build_record(record, index);
    Footer footer;
    footer.index_offset = end;
    footer.file_bytes = end + buffer.size() + kUnit;
    footer.record_count = entries.size() + 1;
    footer.dump_id = file_header.dump_id();
    footer.data_record_count = data_records;
    footer.flags = data_records == geometry.slot_count() ? kFlagComplete : 0;
    const UnitBytes tail = encode(footer);
    buffer.insert(buffer.end(), tail.begin(), tail.end());
    if (auto put = file.write_at(end, buffer); !put) return stop_after(std::move(put).error());
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
  if (!options.force && is_there(path)) {
    return fail(ErrorCode::kUsage, "{}: already exists: remove it or use --force", path.string());
  }
  auto state = std::make_unique<State>();
  state->path = path;
  state->options = options;
  state->header = header;
  if (options.uuid) {
    state->header.uuid = *options.uuid;
  } else {
    SPOOL_ASSIGN(state->header.uuid, random_uuid(path));
  }
  state->file_header.dump_uuid = state->header.uuid;
  state->geometry = DumpGeometry(header);
  state->written.resize(state->geometry.slot_count());
  SPOOL_ASSIGN(state->file, open_partial(partial_name(path), options.force));
  SPOOL_TRY(state->write_preamble());
  return SpoolWriter(std::move(state));
}

const DumpHeader& SpoolWriter::header() const {
  return state_->header;
}

bool SpoolWriter::has_block(uint16_t group, uint32_t tile, uint32_t block) const {
  const auto slot = state_->geometry.slot(group, tile, block);
  return slot && state_->written[*slot];
}

Result<void> SpoolWriter::write_meta(std::string_view json) {
  State& state = *state_;
  SPOOL_TRY(state.check_running());
  if (const auto valid = check_meta(json); !valid) {
    return fail(ErrorCode::kUsage, "{}: {}: give one JSON object", state.path.string(),
                valid.error().what);
  }
  if (state.meta_records == kMaxMetaRecords) {
    return fail(ErrorCode::kUsage, "{}: more than {} meta records: join them", state.path.string(),
                kMaxMetaRecords);
  }
  SPOOL_TRY(state.append_plain(kTypeMeta, std::as_bytes(std::span(json))));
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
                "{}: {} (group {} tile {} samples {}+{}): see formats/spool.md 4.3",
                state.path.string(), block.error().what, group, tile, sample_begin, sample_count);
  }
  const uint32_t slot = *state.geometry.slot(group, tile, *block);
  if (state.written[slot]) {
    return fail(ErrorCode::kUsage, "{}: block was written before (group {} tile {} samples {}+{})",
                state.path.string(), group, tile, sample_begin, sample_count);
  }
  std::optional<std::vector<std::byte>> packed;
  if (state.options.compress) {
    packed = compress_payload(payload, bytes_per_value(state.geometry.groups()[group].type));
  }
  if (packed) {
    record.codec = static_cast<uint8_t>(Codec::kZstd);
    record.filter = static_cast<uint8_t>(Filter::kByteShuffle);
  }
  SPOOL_TRY(state.append(record, packed ? std::span<const std::byte>(*packed) : payload));
  state.written[slot] = true;
  ++state.data_records;
  return {};
}

Result<void> SpoolWriter::finish() {
  State& state = *state_;
  SPOOL_TRY(state.check_running());
  SPOOL_TRY(state.write_index_and_footer());
  SPOOL_TRY(state.sync());
  state.stopped = true;
  SPOOL_TRY(rename_file(partial_name(state.path), state.path, state.options.force));
  SPOOL_TRY(sync_directory(state.path.parent_path()));
  return state.file.close();
}

}  // namespace spool::format
