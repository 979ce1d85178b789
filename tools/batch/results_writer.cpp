#include "tools/batch/results_writer.h"

#include <utility>

#include "lib/experiment/result_table.h"

namespace spool::tools {

ResultsWriter::ResultsWriter(AtomicFile csv, AtomicFile lines)
    : csv_file_(std::move(csv)),
      lines_file_(std::move(lines)),
      csv_(csv_file_.temporary_path(), std::ios::binary),
      lines_(lines_file_.temporary_path(), std::ios::binary) {
  csv_ << csv_header() << '\n';
}

Result<ResultsWriter> ResultsWriter::create(const std::filesystem::path& folder) {
  SPOOL_ASSIGN(AtomicFile csv, AtomicFile::create(folder / "results.csv", true, true));
  SPOOL_ASSIGN(AtomicFile lines, AtomicFile::create(folder / "results.jsonl", true, true));
  return ResultsWriter(std::move(csv), std::move(lines));
}

void ResultsWriter::add(const std::vector<std::string>& fields) {
  csv_ << to_csv_row(fields) << '\n';
  lines_ << to_json_line(fields) << '\n';
}

Result<void> ResultsWriter::finish() {
  for (std::ofstream* file : {&csv_, &lines_}) {
    file->close();
    if (!*file) {
      return fail(ErrorCode::kIo, "{}: cannot be written: check the disk",
                  (file == &csv_ ? csv_file_ : lines_file_).temporary_path().string());
    }
  }
  SPOOL_TRY(csv_file_.commit());
  return lines_file_.commit();
}

}  // namespace spool::tools
