// Runs imports and exports for the tests: one job per input line, fields separated by tabs,
//   VERB IN OUT [KEY=VALUE ...]
// and answers each with one line: "0 NOTES", or the exit code and the message of the refusal.
#include <iostream>
#include <map>
#include <sstream>

#include "formats/interchange/zip_directory.h"
#include "formats/interchange/zip_writer.h"
#include "lib/exchange/foreign_formats.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/foreign_picture.h"

namespace {

using namespace spool;
using namespace spool::interchange;

struct Job {
  std::string verb, in, out;
  std::map<std::string, std::string> options;

  bool has(const std::string& key) const { return options.contains(key); }
};

Job parse(const std::string& line) {
  std::istringstream fields(line);
  Job job;
  std::getline(fields, job.verb, '\t');
  std::getline(fields, job.in, '\t');
  std::getline(fields, job.out, '\t');
  for (std::string field; std::getline(fields, field, '\t');) {
    const size_t equals = field.find('=');
    job.options[field.substr(0, equals)] =
        equals == std::string::npos ? "" : field.substr(equals + 1);
  }
  return job;
}

// "import FORMAT": the options are those of the format, and of all formats force, compress, tile,
// block.
Result<ImportReport> run_import(const Job& job) {
  const std::string name = job.verb.substr(std::string_view("import ").size());
  ImportOptions common;
  common.force = job.has("force");
  common.compress = job.has("compress");
  OptionValues set;
  for (const auto& [key, value] : job.options) {
    if (key == "tile") common.tile_size = static_cast<uint32_t>(std::stoul(value));
    if (key == "block") common.block_spp = static_cast<uint32_t>(std::stoul(value));
    if (key == "force" || key == "compress" || key == "tile" || key == "block") continue;
    set.emplace_back(key, value.empty() ? "on" : value);
  }
  for (const ImportFormat& format : exchange::import_formats()) {
    if (format.name == name) return format.import(job.in, job.out, common, set);
  }
  return fail(ErrorCode::kUsage, "no format {}", name);
}

Result<ExportReport> run_export(const Job& job) {
  const std::string name = job.verb.substr(std::string_view("export ").size());
  OptionValues set;
  for (const auto& [key, value] : job.options)
    if (key != "force") set.emplace_back(key, value);
  for (const ExportFormat& format : exchange::export_formats()) {
    if (format.name == name) return format.write(job.in, job.out, {.force = job.has("force")}, set);
  }
  return fail(ErrorCode::kUsage, "no format {}", name);
}

template <class Report>
Result<std::string> notes_of(const Result<Report>& report) {
  if (!report) return tl::unexpected(report.error());
  std::string text;
  for (const std::string& note : report->notes)
    text += note + "; ";
  return text;
}

Result<std::string> run(const Job& job) {
  if (job.verb.starts_with("import ")) return notes_of(run_import(job));
  if (job.verb.starts_with("export ")) return notes_of(run_export(job));
  if (job.verb == "picture") {  // as metrics, picture and image:FILE read it, into OUT
    LayerChoice choice;
    if (job.has("layer")) choice.layer = job.options.at("layer");
    if (job.has("part")) choice.part = job.options.at("part");
    SPOOL_ASSIGN(ForeignPicture picture, read_picture(job.in, choice));
    SPOOL_TRY(write_exr(job.out, exr_from_rgb(std::move(picture.rgb)), {.overwrite = true}));
    return remark_line(job.in, picture.remarks);
  }
  if (job.verb == "sparse_zip") {  // 5 GiB of zeros, then three bytes: sizes and offsets past 4 GiB
    std::vector<PlannedMember> members = {{"big", uint64_t{5} << 30}, {"small", 3}};
    plan_zip(members);
    SPOOL_ASSIGN(auto file, format::FileHandle::open(job.out, format::OpenMode::kCreate));
    SPOOL_TRY(file.write_at(members[1].data_offset, std::as_bytes(std::span("abc", 3))));
    SPOOL_TRY(finish_zip(file, members));
    SPOOL_ASSIGN(const auto found, read_zip_directory(file));
    std::string text;
    for (const ZipMember& member : found)
      text += fmt::format("{} {} {}; ", member.name, member.bytes, member.data_offset);
    return text;
  }
  return fail(ErrorCode::kUsage, "no verb {}", job.verb);
}

}  // namespace

int main() {
  for (std::string line; std::getline(std::cin, line);) {
    const auto result = run(parse(line));
    if (result)
      std::cout << "0 " << *result << '\n';
    else
      std::cout << static_cast<int>(result.error().code) << ' ' << result.error().message << '\n';
  }
  return 0;
}
