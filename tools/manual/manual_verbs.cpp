#include "tools/manual/manual_verbs.h"

#include "lib/core/nearest_name.h"
#include "lib/image_io/atomic_file.h"
#include "tools/manual/completion.h"
#include "tools/manual/man_page.h"

namespace spool::tools {
namespace {

Result<void> write_pages(const std::vector<ManPage>& pages, const std::filesystem::path& folder,
                         bool overwrite) {
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  for (const ManPage& page : pages)
    SPOOL_TRY(write_text_file(folder / page.file, page.text, overwrite));
  return {};
}

}  // namespace

Result<void> run_completion(const CompletionOptions& options, const ProgramText& program) {
  SPOOL_ASSIGN(const std::string script, completion_script(program, options.shell));
  print(script);
  return {};
}

Result<void> run_man(const ManOptions& options, const CommonOptions& common,
                     const ProgramText& program) {
  const std::vector<ManPage> pages = man_pages(program);
  if (!options.output.empty()) return write_pages(pages, options.output, common.force);
  if (options.verb.empty()) {
    print(pages.front().text);
    return {};
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < program.verbs.size(); ++i) {
    names.push_back(program.verbs[i].name);
    if (names.back() != options.verb) continue;
    print(pages[i + 1].text);
    return {};
  }
  return fail(ErrorCode::kUsage, "{}", unknown_name("verb", options.verb, names));
}

}  // namespace spool::tools
