#include "tools/verbs/page_generator.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include <sys/wait.h>
#include <unistd.h>

#include "tools/methods/watched_process.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using TemporaryFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

constexpr const char* kRunner = "run.py";

std::string from_environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Beside the installed program, or in the source tree that the program was built from.
Result<fs::path> find_runner() {
  const std::string chosen = from_environment("SPOOL_REPORT");
  std::vector<fs::path> folders;
  std::error_code status;
  if (!chosen.empty()) {
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

std::string contents(std::FILE* file) {
  std::string text;
  std::array<char, 4096> buffer{};
  std::rewind(file);
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), file)) > 0;)
    text.append(buffer.data(), n);
  while (text.ends_with('\n'))
    text.pop_back();
  return text;
}

PythonRun run_program(std::vector<std::string> words, const std::string& input,
                      PythonErrors errors) {
  const TemporaryFile in(std::tmpfile(), std::fclose), out(std::tmpfile(), std::fclose),
      err(std::tmpfile(), std::fclose);
  PythonRun run{words.front()};
  if (!in || !out || !err) return run;
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size()) return run;
  std::rewind(in.get());
  const Streams streams{fileno(in.get()), fileno(out.get()),
                        errors == PythonErrors::kKept ? fileno(err.get()) : STDERR_FILENO};
  pid_t child = 0;
  if (spawn_watched(std::move(words), streams, 0, nullptr, child) != 0) return run;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  forget_watched(child);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = contents(out.get());
  run.err = contents(err.get());
  return run;
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

// To be tried one after the other: SPOOL_PYTHON alone where it is set. Another Python before the
// system's on the path often lacks the system's numpy.
std::vector<std::string> python_interpreters() {
  const std::string chosen = from_environment("SPOOL_PYTHON");
  if (!chosen.empty()) return {chosen};
  return {"python3", "/usr/bin/python3"};
}

}  // namespace

PythonRun run_python(std::vector<std::string> arguments, int lacks, const std::string& input,
                     PythonErrors errors) {
  arguments.insert(arguments.begin(), "");
  PythonRun run;
  for (const std::string& python : python_interpreters()) {
    arguments.front() = python;
    run = run_program(arguments, input, errors);
    if (run.exit_code != kPythonNotFound && run.exit_code != lacks) break;
  }
  return run;
}

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
