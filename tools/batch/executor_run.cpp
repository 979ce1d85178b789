#include "tools/batch/executor_run.h"

#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/experiment/plan_text.h"
#include "lib/image_io/atomic_file.h"
#include "tools/methods/watched_process.h"
#include "tools/terminal/interrupt.h"
#include "tools/verbs/page_generator.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kNoPackage = 20;
constexpr int kWasWorker = 21;  // a process of MPI that worked for another one
constexpr int kNotFound = 127;

// Not from the current folder, which may hold files of any name; from beside the program where it
// was built.
constexpr std::string_view kStart = R"(import sys
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

struct Ended {
  int exit_code = kNotFound;
  std::string said;  // the last line
};

// What it prints as errors, how far it is above all, goes where this program's does.
Ended run_python(std::vector<std::string> words) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::tmpfile(), std::fclose);
  Ended ended;
  pid_t child = 0;
  if (!out || spawn_watched(std::move(words), {-1, fileno(out.get()), STDERR_FILENO}, 0, nullptr,
                            child) != 0)
    return ended;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  forget_watched(child);
  ended.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::rewind(out.get());
  std::string line;
  for (int c = std::fgetc(out.get()); c != EOF; c = std::fgetc(out.get())) {
    if (c != '\n') {
      line += static_cast<char>(c);
    } else {
      ended.said = std::exchange(line, {});
    }
  }
  return ended;
}

}  // namespace

Result<bool> run_on_workers(const RunRequest& request, const std::string& executor,
                            const CommonOptions& common) {
  SPOOL_ASSIGN(const ExchangeFolder scratch, ExchangeFolder::create());
  const fs::path plan = scratch / "plan.toml";
  SPOOL_TRY(write_text_file(plan, plan_text(request.plan), true));
  std::vector<std::string> words = {"",
                                    "-c",
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
  Ended ended;
  for (const std::string& python : python_interpreters()) {
    words.front() = python;
    ended = run_python(words);
    if (ended.exit_code != kNotFound && ended.exit_code != kNoPackage) break;
  }
  if (ended.exit_code == 0 || ended.exit_code == kWasWorker) return ended.exit_code == 0;
  if (ended.exit_code == kNotFound || ended.exit_code == kNoPackage) {
    return fail(
        ErrorCode::kUsage,
        "--executor {}: {} has no package spool with its workers: pip install spool-lab, or "
        "let SPOOL_PYTHON name the interpreter that has it",
        executor, words.front());
  }
  const bool known = ended.exit_code <= 4 && !ended.said.empty();
  return fail(
      known ? static_cast<ErrorCode>(ended.exit_code) : ErrorCode::kData, "{}",
      known ? ended.said
            : fmt::format("--executor {}: Python ended with code {}", executor, ended.exit_code));
}

}  // namespace spool::tools
