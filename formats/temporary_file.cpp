#include "formats/temporary_file.h"

#include <sys/random.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace spool::format {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".spool-", kSuffix = ".partial";
constexpr std::size_t kRandomLetters = 8;
constexpr std::size_t kLongestName = 255;  // of a file, on every usual file system
constexpr int kTries = 100;

bool is_temporary_name(std::string_view name) {
  const std::size_t tail = kMark.size() + kRandomLetters + kSuffix.size();
  return name.size() > tail && name.ends_with(kSuffix) &&
         name.substr(name.size() - tail).starts_with(kMark);
}

}  // namespace

tl::unexpected<Error> named_after(const fs::path& target, const fs::path& name, Error error) {
  const std::string prefix = name.string();
  if (error.message.starts_with(prefix))
    error.message.replace(0, error.message.find(": ", prefix.size()), target.string());
  return fail(error.code, "{}", error.message);
}

fs::path temporary_name(const fs::path& target) {
  const std::string tail = std::string(kMark) + random_letters() + std::string(kSuffix);
  const std::string name = target.filename().string();
  return target.parent_path() / (name.substr(0, kLongestName - 1 - tail.size()) + tail);
}

std::string random_letters() {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz234567";  // 5 bits each
  std::array<unsigned char, kRandomLetters> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes.at(i) = static_cast<unsigned char>(now >> (5 * i));
  }
  std::string text;
  for (const unsigned char byte : bytes)
    text += kLetters[byte % kLetters.size()];
  return text;
}

Result<TemporaryFile> TemporaryFile::create(const fs::path& target) {
  SPOOL_TRY(refuse_special_file(target));
  for (int i = 0; i < kTries; ++i) {
    TemporaryFile made;
    made.target_ = target;
    made.found_ = identity_of(target);
    const fs::path name = temporary_name(target);
    const auto make = [&]() -> Result<void> {
      SPOOL_ASSIGN(made.file_, FileHandle::open(name, OpenMode::kCreate));
      return {};
    };
    auto begun = UnfinishedFile::begin(name, make);
    if (!begun) return named_after(target, name, std::move(begun).error());
    made.unfinished_ = std::move(*begun);
    // Between the two calls another process may have removed it as a dead one.
    SPOOL_ASSIGN(const bool ours, made.file_.hold(name));
    if (ours) return made;
  }
  return fail(ErrorCode::kIo, "{}: no temporary file can be made beside it: try again",
              target.string());
}

Result<void> TemporaryFile::publish(Replace replace) {
  SPOOL_TRY(file_.sync());
  return unfinished_.finish([&]() -> Result<void> {
    const FolderLock lock(target_.parent_path());
    SPOOL_ASSIGN(const bool named, file_.is_named(path()));
    if (!named) {
      return fail(ErrorCode::kIo, "{}: its temporary file was removed: nothing was changed",
                  target_.string());
    }
    const bool changed = identity_of(target_) != found_;
    if (changed &&
        (replace == Replace::kWhatWasHere || (replace == Replace::kNothing && !found_))) {
      return written_meanwhile(target_);
    }
    return rename_file(path(), target_, replace != Replace::kNothing);
  });
}

Result<FileHandle> open_scratch_file(const fs::path& out) {
  SPOOL_ASSIGN(TemporaryFile made, TemporaryFile::create(out));
  return std::move(made.file());  // its name goes with `made`: it lives as long as it is open
}

std::size_t sweep_temporary_files(const fs::path& folder, std::chrono::seconds age) {
  std::size_t removed = 0;
  std::error_code status;
  const auto now = fs::file_time_type::clock::now();
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    if (!is_temporary_name(entry.path().filename().string())) continue;
    std::error_code ignored;
    if (entry.is_symlink(ignored) || !entry.is_regular_file(ignored)) continue;
    if (age.count() > 0 && now - entry.last_write_time(ignored) < age) continue;
    auto file = FileHandle::open(entry.path(), OpenMode::kAppend);
    if (!file) continue;
    const auto locked = file->try_lock();
    if (!locked || !*locked || !file->is_named(entry.path()).value_or(false)) continue;
    if (fs::remove(entry.path(), ignored)) ++removed;
  }
  return removed;
}

}  // namespace spool::format
