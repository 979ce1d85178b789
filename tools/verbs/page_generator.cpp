#include "tools/verbs/page_generator.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
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

struct Finished {
  int exit_code = 0;
  std::string out, err;
};

// Runs a program found on the path; `input` becomes its standard input.
std::optional<Finished> run_program(std::vector<std::string> words, const std::string& input) {
  const TemporaryFile in(std::tmpfile(), std::fclose), out(std::tmpfile(), std::fclose),
      err(std::tmpfile(), std::fclose);
  if (!in || !out || !err) return std::nullopt;
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size()) return std::nullopt;
  std::rewind(in.get());
  const Streams streams{fileno(in.get()), fileno(out.get()), fileno(err.get())};
  pid_t child = 0;
  const bool started = spawn_watched(std::move(words), streams, 0, nullptr, child) == 0;
  int status = 0;
  if (!started || waitpid(child, &status, 0) != child) return std::nullopt;
  forget_watched(child);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return Finished{code, contents(out.get()), contents(err.get())};
}

constexpr int kNotFound = 127;
constexpr int kNoNumpy = 20;  // tools/report/run.py

// The generator ends with one line; a traceback's last line says most.
Error error_of(const Finished& finished) {
  const std::string line = finished.err.substr(finished.err.find_last_of('\n') + 1);
  const bool known = finished.exit_code >= 1 && finished.exit_code <= 3;
  return {known ? static_cast<ErrorCode>(finished.exit_code) : ErrorCode::kData,
          line.empty() ? fmt::format("the report generator ended with code {}", finished.exit_code)
                       : line};
}

}  // namespace

// SPOOL_PYTHON alone where it is set. Another Python before the system's on the path often lacks
// the system's numpy.
std::vector<std::string> python_interpreters() {
  const std::string chosen = from_environment("SPOOL_PYTHON");
  if (!chosen.empty()) return {chosen};
  return {"python3", "/usr/bin/python3"};
}

Result<std::string> run_generator(const std::string& script, std::vector<std::string> arguments,
                                  const std::string& input, const GeneratorNeeds& needs) {
  SPOOL_ASSIGN(const fs::path runner, find_runner());
  arguments.insert(arguments.begin(), {"", runner.string(), script});
  std::optional<Finished> finished;
  for (const std::string& python : python_interpreters()) {
    arguments.front() = python;
    finished = run_program(arguments, input);
    if (finished && finished->exit_code != kNotFound && finished->exit_code != kNoNumpy) break;
  }
  if (!finished || finished->exit_code == kNotFound || finished->exit_code == kNoNumpy) {
    const bool wheel = runner.string().find("-packages/") != std::string::npos;
    return fail(ErrorCode::kUsage,
                "{}: {}: {} needs Python 3.9 or newer with {} ({}); SPOOL_PYTHON names another "
                "interpreter",
                arguments.front(),
                finished && finished->exit_code == kNoNumpy ? "has no " + needs.packages
                                                            : "cannot be started",
                needs.verb, needs.packages,
                wheel ? "pip install 'spool-lab[figures]'" : "apt-get install " + needs.debian);
  }
  if (finished->exit_code != 0) return tl::unexpected<Error>(error_of(*finished));
  return finished->out;
}

}  // namespace spool::tools
