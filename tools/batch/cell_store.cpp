#include "tools/batch/cell_store.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/temporary_file.h"
#include "lib/core/check.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/result_table.h"
#include "tools/batch/cell_text.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKeptLines = "kept.jsonl";
constexpr std::uint64_t kReadAtOnce = 1 << 20;
constexpr std::size_t kLongestLine = std::size_t{16} << 20;
constexpr std::size_t kOpenAtOnce = 100;  // files; a process may have a thousand
constexpr std::chrono::seconds kSyncEvery{1};

fs::path cells_of(const fs::path& folder) {
  return folder / "cells";
}

tl::unexpected<Error> failed_on(const fs::path& path, const std::error_code& status) {
  return fail(ErrorCode::kIo, "{}: {}", path.string(), status.message());
}

}  // namespace

bool CellStore::is_in(const fs::path& folder) {
  std::error_code status;
  return fs::is_directory(cells_of(folder), status);
}

Result<void> CellStore::create(const fs::path& folder) {
  std::error_code status;
  fs::create_directories(cells_of(folder), status);
  if (status) return failed_on(cells_of(folder), status);
  return {};
}

Result<void> CellStore::remove_all(const fs::path& folder) {
  std::error_code status;
  for (const fs::path& held : {cells_of(folder), folder / kKeptLines}) {
    fs::remove_all(held, status);
    if (status) return failed_on(held, status);
  }
  return {};
}

Result<CellStore> CellStore::open(const fs::path& folder) {
  CellStore store(folder);
  if (folder.empty()) return store;
  std::error_code status;
  store.kept_ = KeptLines::read(folder / kKeptLines);
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(cells_of(folder), status))
    paths.push_back(entry.path());
  if (status && status != std::errc::no_such_file_or_directory)
    return failed_on(cells_of(folder), status);
  std::ranges::sort(paths);
  for (const fs::path& path : paths) {
    const auto old = cell_number(path.stem().string());
    if (path.extension() == ".json" && old) SPOOL_TRY(store.add_old_cell(path, *old));
    if (path.extension() == ".jsonl") SPOOL_TRY(store.add_file(path));
  }
  store.keep_best();
  return store;
}

Result<void> CellStore::add_old_cell(const fs::path& path, std::uint64_t number) {
  const auto text = format::read_short_text(path);
  if (!text) {
    return fail(ErrorCode::kIo, "{}: cannot be read, or is no regular file: delete it",
                path.string());
  }
  ResultRecord record;
  const bool failed = !read_cell_text(*text, record) || record.failed();
  entries_.push_back({number, 0, static_cast<std::uint32_t>(text->size()),
                      static_cast<std::uint32_t>(files_.size()), failed});
  files_.push_back(path);
  open_.emplace_back();
  return {};
}

Result<void> CellStore::add_file(const fs::path& path) {
  std::error_code status;
  if (!fs::is_regular_file(path, status)) {  // before it is opened: a pipe would wait
    return fail(ErrorCode::kIo, "{}: is no regular file: delete it", path.string());
  }
  SPOOL_ASSIGN(format::FileHandle file, format::FileHandle::open(path, format::OpenMode::kRead));
  SPOOL_ASSIGN(const std::uint64_t bytes, file.size());
  files_.push_back(path);
  std::string text;         // from `begin` of the file on, without its end
  std::uint64_t begin = 0;  // of the line that is read
  std::size_t line_number = 1;
  for (std::uint64_t done = 0; done < bytes;) {
    const std::size_t known = text.size();
    const auto more = static_cast<std::size_t>(std::min<std::uint64_t>(kReadAtOnce, bytes - done));
    text.resize(known + more);
    SPOOL_TRY(file.read_at(done, std::as_writable_bytes(std::span(text).subspan(known))));
    done += more;
    std::size_t at = 0;
    for (std::size_t end = text.find('\n', known); end != std::string::npos;
         end = text.find('\n', at)) {
      add_line(std::string_view(text).substr(at, end - at), begin + at, line_number++);
      at = end + 1;
    }
    begin += at;
    text.erase(0, at);
    if (text.size() > kLongestLine) {  // no file's word for how much memory a line takes
      add_line({}, begin, line_number);
      begin += text.size();
      text.clear();
    }
  }
  open_.emplace_back();
  if (open_.size() <= kOpenAtOnce) open_.back() = std::move(file);
  return {};
}

void CellStore::add_line(std::string_view line, std::uint64_t offset, std::size_t line_number) {
  const auto checked = checked_line(line);
  if (checked && line.size() <= std::numeric_limits<std::uint32_t>::max()) {
    entries_.push_back({checked->number, offset, static_cast<std::uint32_t>(line.size()),
                        static_cast<std::uint32_t>(files_.size() - 1), checked->failed});
  } else if (damaged_++ == 0) {
    first_damage_ = fmt::format("{}, line {}", files_.back().string(), line_number);
  }
}

std::string CellStore::damage() const {
  return fmt::format("{} damaged results count as missing; the first: {}", damaged_, first_damage_);
}

tl::unexpected<Error> nothing_finished(const fs::path& folder, const CellStore& store) {
  return fail(ErrorCode::kData, "{}: no finished results in it{}", folder.string(),
              store.damaged() > 0 ? "; " + store.damage() : "");
}

void CellStore::keep_best() {
  std::ranges::stable_sort(entries_, [](const Entry& a, const Entry& b) {
    return std::pair(a.number, !a.failed) < std::pair(b.number, !b.failed);
  });
  // The last of each is its best.
  const auto rest =
      std::unique(entries_.rbegin(), entries_.rend(),
                  [](const Entry& a, const Entry& b) { return a.number == b.number; });
  entries_.erase(entries_.begin(), rest.base());
}

const CellStore::Entry* CellStore::find(std::uint64_t number) const {
  const auto found = std::ranges::lower_bound(entries_, number, {}, &Entry::number);
  return found == entries_.end() || found->number != number ? nullptr : &*found;
}

Result<std::string> CellStore::text_of(const Entry& entry) const {
  std::string text(entry.bytes, '\0');
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(text));
  if (const auto& file = open_[entry.file]) {
    SPOOL_TRY(file->read_at(entry.offset, bytes));
  } else {
    SPOOL_ASSIGN(const format::FileHandle again,
                 format::FileHandle::open(files_[entry.file], format::OpenMode::kRead));
    SPOOL_TRY(again.read_at(entry.offset, bytes));
  }
  return text;
}

Result<ResultRecord> CellStore::record_at(const Entry& entry) const {
  SPOOL_ASSIGN(const std::string text, text_of(entry));
  ResultRecord record;
  if (!read_cell_text(text, record))
    return fail(ErrorCode::kData, "{}: is no result of a cell", files_[entry.file].string());
  return record;
}

Result<ResultRecord> CellStore::read(const std::string& id, const Cell& cell) const {
  const auto number = cell_number(id);
  const Entry* entry = number ? find(*number) : nullptr;
  ResultRecord asked, record;
  CellResult empty;
  empty.cell = cell;
  for (const ResultColumn& column : result_columns())
    asked.fields.push_back(column.kind == ColumnKind::kCell ? column.text(empty) : "");
  if (entry) {
    SPOOL_ASSIGN(record, record_at(*entry));
  } else if (const ResultRecord* kept = kept_.find(asked)) {
    record = *kept;
  } else {
    return fail(ErrorCode::kIo, "{}: {} is not finished yet", cells_of(folder_).string(), id);
  }
  for (std::size_t i = 0; i < result_columns().size(); ++i)
    if (result_columns()[i].kind == ColumnKind::kCell) record.fields[i] = asked.fields[i];
  return record;
}

std::size_t CellStore::count_others(const std::function<bool(const std::string&)>& known) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      entries_, [&](const Entry& entry) { return !known(cell_id(entry.number)); }));
}

Result<void> CellStore::take_from(const CellStore& other) {
  std::vector<Entry> wanted;
  for (const Entry& entry : other.entries_) {
    const Entry* own = find(entry.number);
    if (!own || (own->failed && !entry.failed)) wanted.push_back(entry);
  }
  std::ranges::sort(wanted, [](const Entry& a, const Entry& b) {  // as the disk has them
    return std::pair(a.file, a.offset) < std::pair(b.file, b.offset);
  });
  for (const Entry& entry : wanted) {
    if (other.files_[entry.file].extension() == ".jsonl") {
      SPOOL_ASSIGN(std::string line, other.text_of(entry));
      SPOOL_TRY(append(std::move(line)));
    } else if (const auto record = other.record_at(entry)) {
      SPOOL_TRY(append(cell_line(entry.number, *record)));
    }
  }
  return sync();
}

Result<void> CellStore::write(const std::string& id, const ResultRecord& record) {
  const auto number = cell_number(id);
  SPOOL_CHECK(number.has_value());
  return append(cell_line(*number, record));
}

Result<void> CellStore::append(std::string line) {
  if (!own_) {
    const fs::path path = cells_of(folder_) / (format::random_letters() + ".jsonl");
    SPOOL_ASSIGN(own_, format::FileHandle::open(path, format::OpenMode::kCreate));
    synced_ = std::chrono::steady_clock::now();
  }
  line += '\n';
  if (auto written = own_->write_at(own_bytes_, std::as_bytes(std::span(line))); !written) {
    static_cast<void>(own_->truncate(own_bytes_));  // half a line counts as missing, too
    return written;
  }
  own_bytes_ += line.size();
  return std::chrono::steady_clock::now() - synced_ < kSyncEvery ? Result<void>{} : sync();
}

Result<void> CellStore::sync() {
  synced_ = std::chrono::steady_clock::now();
  return own_ ? own_->sync() : Result<void>{};
}

}  // namespace spool::tools
