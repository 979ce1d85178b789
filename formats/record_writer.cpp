#include "formats/record_writer.h"

#include <algorithm>
#include <cstring>

#include "formats/checked_math.h"
#include "formats/crc32.h"

namespace spool::format {

namespace {

// How much a power failure may cost, besides RecordWriter::sync_every.
constexpr std::chrono::seconds kSyncInterval{30};

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

tl::unexpected<Error> written_by_another(const std::filesystem::path& partial) {
  return fail(ErrorCode::kIo, "{}: another process is writing it: wait or choose another name",
              partial.string());
}

// A NAME.partial that is there: emptied when it is to be replaced and has no writer.
Result<FileHandle> reopen_partial(const std::filesystem::path& partial, bool force) {
  SPOOL_ASSIGN(FileHandle file, FileHandle::open(partial, OpenMode::kAppend));
  SPOOL_TRY(file.size());
  // Its writer may have finished and renamed it between the two calls: then it is no longer ours.
  SPOOL_ASSIGN(const bool ours, file.hold(partial));
  if (!ours) return written_by_another(partial);
  if (!force) {
    return fail(
        ErrorCode::kUsage,
        "{}: an unfinished recording is there: resume or recover it, delete it or use --force",
        partial.string());
  }
  SPOOL_TRY(file.truncate(0));
  return file;
}

Result<FileHandle> open_partial(const std::filesystem::path& partial, bool force) {
  if (is_there(partial)) return reopen_partial(partial, force);
  Result<FileHandle> file = FileHandle::open(partial, OpenMode::kCreate);
  if (!file && is_there(partial)) return written_by_another(partial);  // since a moment ago
  if (!file) return file;
  const Result<bool> ours = file->hold(partial);
  if (ours && *ours) return file;
  if (ours) return written_by_another(partial);
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);  // made a moment ago, and empty
  return tl::unexpected(ours.error());
}

Result<void> remove_partial(const std::filesystem::path& partial, bool force) {
  if (!is_there(partial)) return {};
  SPOOL_ASSIGN(const FileHandle file, reopen_partial(partial, force));
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  return {};
}

}  // namespace

std::filesystem::path partial_name(const std::filesystem::path& path, bool remade) {
  std::filesystem::path partial = path;
  partial += remade ? ".remade.partial" : ".partial";
  return partial;
}

Result<RecordWriter> RecordWriter::create(const std::filesystem::path& path,
                                          const FileHeader& header, bool force, bool discard) {
  if (!force && is_there(path)) {
    return fail(ErrorCode::kUsage, "{}: already exists: remove it or use --force", path.string());
  }
  SPOOL_TRY(refuse_special_file(path));
  RecordWriter writer;
  writer.path_ = path;
  writer.header_ = header;
  writer.partial_ = partial_name(path, discard);
  writer.force_ = force;
  if (discard) SPOOL_TRY(remove_partial(partial_name(path), force));
  const auto open = [&]() -> Result<void> {
    SPOOL_ASSIGN(writer.file_, open_partial(writer.partial_, force || discard));
    return {};
  };
  SPOOL_ASSIGN(writer.discarded_, UnfinishedFile::begin(writer.partial_, open));
  // A file that holds no record is worth nothing and would stand in the way of the next try.
  SPOOL_TRY(writer.file_.write_at(0, encode(header)));
  if (!discard) SPOOL_TRY(writer.discarded_.finish([] { return Result<void>(); }));
  writer.end_ = kUnit;
  return writer;
}

Result<RecordWriter> RecordWriter::resume(const std::filesystem::path& path, FileHandle file,
                                          const FileHeader& header, std::vector<IndexEntry> entries,
                                          uint64_t end, bool force) {
  RecordWriter writer;
  writer.path_ = path;
  writer.partial_ = partial_name(path);
  writer.file_ = std::move(file);
  writer.header_ = header;
  writer.entries_ = std::move(entries);
  writer.end_ = end;
  writer.force_ = force;
  SPOOL_TRY(writer.file_.truncate(end));
  return writer;
}

Result<void> RecordWriter::check_running() const {
  if (!stopped_) return {};
  return fail(ErrorCode::kUsage, "{}: the writer has stopped: open a new one", path_.string());
}

Result<void> RecordWriter::stop_after(Error error) {
  stopped_ = true;
  // If this fails too, the torn record is what resume and recovery cut off.
  static_cast<void>(file_.truncate(end_));
  return tl::unexpected(std::move(error));
}

Result<void> RecordWriter::sync() {
  if (auto synced = file_.sync(); !synced) {
    stopped_ = true;  // a failed fsync is final
    return synced;
  }
  synced_until_ = end_;
  synced_at_ = std::chrono::steady_clock::now();
  return {};
}

void RecordWriter::build(RecordHeader& record, std::span<const std::byte> stored) {
  record.sequence = entries_.size();
  record.dump_id = header_.dump_id();
  record.stored_bytes = stored.size();
  record.payload_crc32 = crc32(stored);
  const UnitBytes head = encode(record);
  buffer_.resize(kUnit + *checked_pad64(stored.size()));  // no byte is set twice but the pad
  std::memcpy(buffer_.data(), head.data(), kUnit);
  std::memcpy(buffer_.data() + kUnit, stored.data(), stored.size());
  std::fill(buffer_.begin() + static_cast<std::ptrdiff_t>(kUnit + stored.size()), buffer_.end(),
            std::byte{0});
}

Result<void> RecordWriter::append(RecordHeader record, std::span<const std::byte> stored) {
  SPOOL_TRY(check_running());
  if (entries_.size() + 2 > kMaxRecords) {
    return fail(ErrorCode::kUsage, "{}: more than {} records: use larger blocks", path_.string(),
                kMaxRecords);
  }
  build(record, stored);
  if (auto put = file_.write_at(end_, buffer_); !put) return stop_after(std::move(put).error());
  entries_.push_back({end_, record});
  end_ += buffer_.size();
  const bool due = end_ - synced_until_ >= sync_every_ ||
                   std::chrono::steady_clock::now() - synced_at_ >= kSyncInterval;
  if (due) return sync();
  return {};
}

Result<void> RecordWriter::append_plain(std::string_view type, std::span<const std::byte> payload) {
  RecordHeader record;
  record.type = record_type(type);
  record.raw_bytes = payload.size();
  return append(record, payload);
}

Result<void> RecordWriter::seal(uint64_t data_records, uint32_t flags) {
  SPOOL_TRY(check_running());
  std::vector<std::byte> index;
  index.reserve(entries_.size() * kUnit);
  for (const IndexEntry& entry : entries_) {
    const UnitBytes bytes = encode(entry);
    index.insert(index.end(), bytes.begin(), bytes.end());
  }
  RecordHeader record;
  record.type = record_type(kTypeIndx);
  record.raw_bytes = index.size();
  build(record, index);
  Footer footer;
  footer.index_offset = end_;
  footer.file_bytes = end_ + buffer_.size() + kUnit;
  footer.record_count = entries_.size() + 1;
  footer.dump_id = header_.dump_id();
  footer.data_record_count = data_records;
  footer.flags = flags;
  const UnitBytes tail = encode(footer);
  buffer_.insert(buffer_.end(), tail.begin(), tail.end());
  if (auto put = file_.write_at(end_, buffer_); !put) return stop_after(std::move(put).error());
  SPOOL_TRY(sync());
  stopped_ = true;
  return {};
}

Result<void> RecordWriter::publish() {
  const auto rename = [&] { return rename_file(partial_, path_, force_); };
  if (!discarded_.path().empty() && !force_ && is_there(path_)) {
    return fail(ErrorCode::kIo,
                "{}: another process wrote it meanwhile: that file stays, this one was dropped",
                path_.string());
  }
  SPOOL_TRY(discarded_.finish(rename));
  SPOOL_TRY(sync_directory(path_.parent_path()));
  // Everything is on disk under its name: what close() says now changes nothing.
  static_cast<void>(file_.close());
  return {};
}

}  // namespace spool::format
