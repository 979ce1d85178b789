#include "tools/verbs/page_generator.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "tools/methods/python_program.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunner = "run.py";

// Beside the installed program, or in the source tree that the program was built from.
Result<fs::path> find_runner() {
  const char* chosen = std::getenv("SPOOL_REPORT");
  std::vector<fs::path> folders;
  std::error_code status;
  if (chosen && *chosen) {
    folders = {chosen};
  } else {
    const fs::path program = fs::read_symlink("/proc/self/exe", status).parent_path();
    for (fs::path up = program; folders.size() < 8 && up.has_relative_path(); up = up.parent_path())
      folders.push_back(up / "tools" / "report");
    folders.insert(folders.begin(), program.parent_path() / "share" / "spool" / "tools" / "report");
  }
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / kRunner, status)) return folder / kRunner;
  }
  return fail(ErrorCode::kIo, "{}: no {} there: set SPOOL_REPORT to the folder that holds it",
              folders.front().string(), kRunner);
}

constexpr int kNoNumpy = 20;  // tools/report/run.py

// The generator ends with one line; a traceback's last line says most.
Error error_of(const PythonRun& finished) {
  const std::string line = finished.err.substr(finished.err.find_last_of('\n') + 1);
  const bool known = finished.exit_code >= 1 && finished.exit_code <= 3;
  return {known ? static_cast<ErrorCode>(finished.exit_code) : ErrorCode::kData,
          line.empty() ? fmt::format("the report generator ended with code {}", finished.exit_code)
                       : line};
}

}  // namespace

Result<std::string> run_generator(const std::string& script, std::vector<std::string> arguments,
                                  const std::string& input, const GeneratorNeeds& needs) {
  SPOOL_ASSIGN(const fs::path runner, find_runner());
  arguments.insert(arguments.begin(), {runner.string(), script});
  const PythonRun run = run_python(std::move(arguments), kNoNumpy, input, PythonErrors::kKept);
  if (run.exit_code == kPythonNotFound || run.exit_code == kNoNumpy) {
    const bool wheel = runner.string().find("-packages/") != std::string::npos;
    return fail(ErrorCode::kUsage,
                "{}: {}: {} needs Python 3.9 or newer with {} ({}); SPOOL_PYTHON names another "
                "interpreter",
                run.python,
                run.exit_code == kNoNumpy ? "has no " + needs.packages : "cannot be started",
                needs.verb, needs.packages,
                wheel ? "pip install 'spool-lab[figures]'" : "apt-get install " + needs.debian);
  }
  if (run.exit_code != 0) return tl::unexpected<Error>(error_of(run));
  return run.out;
}

}  // namespace spool::tools
