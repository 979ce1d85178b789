// Finished cells of an evaluation, one small file each: DIR/cells/ID.json.
//
// A cell counts as finished when its file is there: written under a temporary name, then renamed.
// So a run that was killed is continued from what it has, several processes or machines may fill
// one folder, and the folders of several may be put together. A file that cannot be understood (a
// disk that ran full, another version) counts as missing.
//
// Results may also be kept as lines, DIR/kept.jsonl: each has columns of results.jsonl, and
// `counts` and `halves` as a cell has them. A cell that has no file of its own is read from there.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/experiment/result_record.h"

namespace spool::tools {

class CellStore {
 public:
  explicit CellStore(std::filesystem::path folder);

  Result<void> create() const;
  bool has_any() const;
  Result<void> remove_all() const;

  Result<void> write(const std::string& id, const ResultRecord& record) const;
  // kIo when it is not there, kData when it cannot be understood. The fields that say which cell it
  // is are those of `cell`: a plan may be moved, its recordings too.
  Result<ResultRecord> read(const std::string& id, const Cell& cell) const;
  // How many finished cells there are that `known` does not hold.
  std::size_t count_others(const std::function<bool(const std::string&)>& known) const;
  // Copies cells that are missing here or failed here; returns how many.
  Result<std::size_t> take_from(const CellStore& other) const;

  std::filesystem::path path_of(const std::string& id) const { return cells() / (id + ".json"); }

 private:
  Result<ResultRecord> kept_record(ResultRecord record) const;
  std::filesystem::path cells() const { return folder_ / "cells"; }

  std::filesystem::path folder_;
  // Lines by the columns that say which cell it is; null where there are none.
  std::shared_ptr<const std::map<std::string, nlohmann::ordered_json>> kept_;
};

}  // namespace spool::tools
