// Pictures of an evaluation: a contact sheet and a folder for every result of replicate 0, and one
// sheet of all estimates per recording and budget.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lib/evaluation/experiment.h"
#include "lib/image_io/contact_sheet.h"

namespace spool::tools {

class EvaluationPictures {
 public:
  explicit EvaluationPictures(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Writes what belongs to one result; results of other replicates are passed over.
  Result<void> add(const CellResult& result, const CellImages& images);

  // Writes DUMP_SPPspp.png: reference and all estimates side by side.
  Result<void> finish() const;

  std::string describe() const;  // where they are, in one line

 private:
  Result<void> write_reference(const CellResult& result, const CellImages& images,
                               const std::string& dump, const std::string& stem);

  struct Overview {
    std::string heading;
    std::vector<Panel> panels;
  };

  std::filesystem::path folder_;
  std::vector<std::pair<std::string, Overview>> overviews_;  // file stem, in order of appearance
  std::map<std::string, std::string> dump_names_;            // path: short name, unique
  std::set<std::string> referenced_;                         // names whose reference is written
};

}  // namespace spool::tools
