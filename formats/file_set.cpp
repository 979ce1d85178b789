#include "formats/file_set.h"

#include <ranges>
#include <utility>

#include "formats/file_handle.h"
#include "formats/temporary_file.h"

namespace spool::format {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNew = "new";
constexpr const char* kOld = "old";

}  // namespace

Result<FileSet> FileSet::create(const fs::path& folder, std::vector<std::string> names, bool force,
                                const std::vector<fs::path>& inputs) {
  FileSet set;
  set.folder_ = folder;
  set.names_ = std::move(names);
  for (const std::string& name : set.names_) {
    const fs::path target = folder / name;
    for (const fs::path& input : inputs)
      SPOOL_TRY(refuse_own_input(target, input));
    SPOOL_TRY(refuse_existing_target(target, force));
    SPOOL_TRY(refuse_special_file(target));
    set.found_.push_back(identity_of(target));
  }
  const fs::path hidden = folder / ("." + temporary_name(set.names_.front()).string());
  SPOOL_ASSIGN(set.hidden_, UnfinishedFile::begin(hidden, [&]() -> Result<void> {
                 std::error_code error;
                 for (const char* part : {kNew, kOld})
                   if (!error) fs::create_directories(hidden / part, error);
                 if (!error) return {};
                 return fail(ErrorCode::kIo, "{}: cannot be written ({}): check the path",
                             (folder / set.names_.front()).string(), error.message());
               }));
  return set;
}

Result<void> FileSet::write(const std::string& name,
                            const std::function<Result<void>(const fs::path&)>& write) {
  const fs::path place = hidden_.path() / kNew / name;
  Result<void> written = write(place);
  if (written) return {};
  return named_after(folder_ / name, place, std::move(written).error());
}

Result<void> FileSet::exchange(bool& undone) {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (identity_of(folder_ / names_[i]) != found_[i])
      return written_meanwhile(folder_ / names_[i]);
  std::vector<std::pair<fs::path, fs::path>> done;
  const auto move = [&](const fs::path& from, const fs::path& to) -> Result<void> {
    if (!identity_of(from)) return {};
    SPOOL_TRY(rename_file(from, to, false));
    done.emplace_back(from, to);
    return {};
  };
  Result<void> moved;
  for (const std::string& name : names_)
    if (moved) moved = move(folder_ / name, hidden_.path() / kOld / name);
  for (const std::string& name : names_)
    if (moved) moved = move(hidden_.path() / kNew / name, folder_ / name);
  if (moved) return {};
  for (const auto& [from, to] : std::views::reverse(done))
    undone = rename_file(to, from, false).has_value() && undone;
  return moved;
}

Result<void> FileSet::publish() {
  const fs::path hidden = hidden_.path();
  Result<void> exchanged;
  bool undone = true;
  SPOOL_TRY(hidden_.finish([&]() -> Result<void> {
    const FolderLock lock(folder_);
    exchanged = exchange(undone);
    if (!exchanged && undone) return exchanged;
    std::error_code ignored;
    if (exchanged) fs::remove_all(hidden, ignored);  // else it holds what could not be put back
    return {};
  }));
  SPOOL_TRY(exchanged);
  return sync_directory(folder_);
}

}  // namespace spool::format
