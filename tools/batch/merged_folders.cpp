#include "tools/batch/merged_folders.h"

#include <utility>

#include "lib/image_io/atomic_file.h"
#include "tools/batch/input_files.h"

namespace spool::tools {

namespace fs = std::filesystem;

Result<std::vector<CellStore>> check_merge(const RunRequest& request, const NamedCells& named,
                                           const std::vector<DumpIdentity>& dumps, bool force) {
  std::vector<CellStore> others;
  if (!request.merge) return others;
  std::error_code status;
  bool empty = !CellStore::is_in(request.folder);
  for (const fs::path& from : request.merge_from) {
    if (!CellStore::is_in(from))
      return fail(ErrorCode::kIo, "{}: has no folder cells: give one that spool evaluate -o wrote",
                  from.string());
    if (fs::exists(from / "kept.jsonl", status))
      return fail(ErrorCode::kUsage,
                  "{}: results that were kept without their cells cannot be merged: leave this "
                  "folder out",
                  (from / "kept.jsonl").string());
    const fs::path inside = fs::weakly_canonical(request.folder, status)
                                .lexically_relative(fs::weakly_canonical(from, status));
    if (!inside.empty() && inside != "." && *inside.begin() != "..")
      return fail(ErrorCode::kUsage,
                  "{}: lies in {}, of which it would hold a copy: choose a folder beside it",
                  request.folder.string(), from.string());
    SPOOL_TRY(check_same_dumps(dumps, from));
    SPOOL_ASSIGN(CellStore other, CellStore::open(from));
    const std::size_t strange = count_others(other, named);
    if (strange > 0 && !force)
      return fail(
          ErrorCode::kUsage,
          "{}: holds {} results that this plan does not have: leave this folder out, or give "
          "--force to take them too",
          from.string(), strange);
    empty = empty && other.empty();
    others.push_back(std::move(other));
  }
  SPOOL_TRY(merged_inputs(request.folder, request.merge_from));
  if (!empty) return others;
  SPOOL_ASSIGN(const CellStore own, CellStore::open(request.folder));
  return nothing_finished(request.folder, own);
}

Result<void> merge_folders(const RunRequest& request, const std::vector<CellStore>& others,
                           CellStore& store) {
  SPOOL_ASSIGN(const std::string inputs, merged_inputs(request.folder, request.merge_from));
  if (!inputs.empty())
    SPOOL_TRY(write_text_file(request.folder / "inputs.json", inputs, true, true));
  for (std::size_t i = 0; i < others.size(); ++i) {
    const fs::path& from = request.merge_from[i];
    std::error_code status;
    if (fs::equivalent(from, request.folder, status)) continue;
    for (const auto& entry : fs::directory_iterator(from, status)) {
      const std::string name = entry.path().filename().string();
      if (name == "cells" || name == "dumps.json" || name == "inputs.json" || name == "plan.toml" ||
          name == "statistics.json" || name.starts_with("results.") || name == "manifest.json" ||
          name.ends_with(".partial")) {
        continue;
      }
      // Claims stay those that were written before the runs of this folder.
      const auto existing = name == "claims.json" ? fs::copy_options::skip_existing
                                                  : fs::copy_options::overwrite_existing;
      fs::copy(entry.path(), request.folder / name, fs::copy_options::recursive | existing, status);
      if (status) {
        return fail(ErrorCode::kIo, "{}: {}", entry.path().string(), status.message());
      }
    }
    SPOOL_TRY(store.take_from(others[i]));  // with its images a cell is done
  }
  return {};
}

}  // namespace spool::tools
