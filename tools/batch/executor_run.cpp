#include "tools/batch/executor_run.h"

#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/experiment/plan_text.h"
#include "lib/image_io/atomic_file.h"
#include "tools/methods/python_program.h"
#include "tools/methods/watched_process.h"
#include "tools/terminal/interrupt.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kNoPackage = 20;
constexpr int kWasWorker = 21;  // a process of MPI that worked for another one

// Not from the current folder, which may hold files of any name; from beside the program where it
// was built. What workers of this machine leave goes with the folder of the plan.
constexpr std::string_view kStart = R"(import os, sys
os.environ["TMPDIR"] = os.path.dirname(sys.argv[2])
os.environ["PYTHONWARNINGS"] = "ignore::UserWarning:multiprocessing.resource_tracker"
sys.path[:1] = filter(None, sys.argv[1:2])
try:
    from spool.on_workers import SpoolError, run
except ImportError:
    sys.exit({0})
try:
    sys.exit(0 if run(*sys.argv[2:]) else {1})
except SpoolError as failure:
    print(failure)
    sys.exit(failure.code)
)";

std::string built_package() {
  std::error_code status;
  const fs::path beside = fs::read_symlink("/proc/self/exe", status).parent_path() / "python";
  return fs::exists(beside / "spool" / "on_workers.py", status) ? beside.string() : "";
}

}  // namespace

Result<bool> run_on_workers(const RunRequest& request, const std::string& executor,
                            const CommonOptions& common) {
  SPOOL_ASSIGN(const ExchangeFolder scratch, ExchangeFolder::create());
  const fs::path plan = scratch / "plan.toml";
  SPOOL_TRY(write_text_file(plan, plan_text(request.plan), true));
  std::vector<std::string> words = {"-c",
                                    fmt::format(kStart, kNoPackage, kWasWorker),
                                    built_package(),
                                    plan.string(),
                                    request.folder.string(),
                                    executor};
  if (common.force) words.emplace_back("force");
  if (request.exact_timing) words.emplace_back("exact");
  if (common.quiet) words.emplace_back("quiet");
  const InterruptNote note([&] {
    return fmt::format("results that arrived are kept in {}: the same command goes on from there",
                       request.folder.string());
  });
  // What it prints as errors is how far it is above all.
  const PythonRun run =
      run_python(std::move(words), kNoPackage, "", PythonErrors::kPrinted, scratch.path());
  if (run.exit_code == 0 || run.exit_code == kWasWorker) return run.exit_code == 0;
  if (run.exit_code == kPythonNotFound || run.exit_code == kNoPackage) {
    return fail(ErrorCode::kUsage,
                "--executor {}: {} has no package spool with its workers: install its wheel "
                "(docs/python.md), or let SPOOL_PYTHON name the interpreter that has it",
                executor, run.python);
  }
  const std::string said = run.out.substr(run.out.find_last_of('\n') + 1);
  const bool known = run.exit_code <= 4 && !said.empty();
  return fail(
      known ? static_cast<ErrorCode>(run.exit_code) : ErrorCode::kData, "{}",
      known ? said
            : fmt::format("--executor {}: Python ended with code {}", executor, run.exit_code));
}

}  // namespace spool::tools
