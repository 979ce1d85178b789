// Images of an evaluation: a folder for every result of replicate 0, of which pictures are drawn
// on demand (kept_images.h), and a sheet of all estimates per recording and budget.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lib/experiment/experiment.h"
#include "lib/experiment/plan.h"

namespace spool::tools {

// A result of replicate 0, for the sheet of all estimates.
struct PicturedResult {
  Cell cell;
  double relmse = 0.0;
};

class EvaluationPictures {
 public:
  // `dumps`: all recordings, in the order that gives their short names.
  EvaluationPictures(std::filesystem::path folder, const std::vector<std::string>& dumps);

  // Writes what belongs to one result; results of other replicates are passed over. kData names an
  // image that cannot hold its numbers; all others are then written.
  Result<void> add(const CellResult& result, const CellImages& images);

  // Name of the folder of a result.
  std::string stem_of(const Cell& cell) const;

  // Of an earlier run, where the result of this one failed.
  void remove(const Cell& cell) const;

  // Of all results that `plan` has, their references and sheets. No file of another name.
  void remove_all(const Plan& plan) const;

  // Writes DUMP_SPPspp.png for every recording and budget from the images in the folder: reference
  // and all estimates side by side. Sheets of more than 24 estimates are left out. Returns where
  // they are, and that some are left out, in one line; empty where there are no results.
  Result<std::string> write_sheets(const std::vector<PicturedResult>& results) const;

 private:
  std::filesystem::path reference_of(const std::string& dump) const;
  std::filesystem::path sheet_of(const std::string& dump, double spp) const;
  Result<void> write_reference(const CellResult& result, const CellImages& images,
                               const std::string& stem);

  std::filesystem::path folder_;
  std::map<std::string, std::string> dump_names_;  // path: short name, unique
  std::set<std::string> referenced_;               // recordings whose reference is written
};

// kUsage where images of two results would have one name: different labels may become one.
Result<void> check_picture_names(const Plan& plan);

}  // namespace spool::tools
