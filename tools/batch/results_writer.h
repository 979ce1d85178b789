// results.csv and results.jsonl of an evaluation, written row by row under temporary names.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/atomic_file.h"

namespace spool::tools {

class ResultsWriter {
 public:
  static Result<ResultsWriter> create(const std::filesystem::path& folder);
  void add(const std::vector<std::string>& fields);  // as result_columns()
  Result<void> finish();                             // kIo when anything could not be written

 private:
  ResultsWriter(AtomicFile csv, AtomicFile lines);

  AtomicFile csv_file_, lines_file_;
  std::ofstream csv_, lines_;
};

}  // namespace spool::tools
