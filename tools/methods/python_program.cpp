#include "tools/methods/python_program.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include <sys/wait.h>
#include <unistd.h>

#include "tools/methods/watched_process.h"

namespace spool::tools {
namespace {

using TemporaryFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string contents(std::FILE* file) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = ::pread(fileno(file), buffer.data(), buffer.size(),
                                   static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  while (text.ends_with('\n'))
    text.pop_back();
  return text;
}

PythonRun run_program(std::vector<std::string> words, const std::string& input, PythonErrors errors,
                      const std::filesystem::path& folder) {
  const TemporaryFile in(std::tmpfile(), std::fclose), out(std::tmpfile(), std::fclose),
      err(std::tmpfile(), std::fclose);
  PythonRun run{words.front()};
  if (!in || !out || !err) return run;
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() ||
      std::fseek(in.get(), 0, SEEK_SET) != 0)
    return run;
  const Streams streams{fileno(in.get()), fileno(out.get()),
                        errors == PythonErrors::kKept ? fileno(err.get()) : STDERR_FILENO, true};
  pid_t child = 0;
  WatchedGroup group(folder);
  if (group.start(std::move(words), streams, nullptr, child) != 0) return run;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = contents(out.get());
  run.err = contents(err.get());
  return run;
}

// To be tried one after the other: SPOOL_PYTHON alone where it is set. Another Python before the
// system's on the path often lacks the system's numpy.
std::vector<std::string> python_interpreters() {
  const char* chosen = std::getenv("SPOOL_PYTHON");
  if (chosen && *chosen) return {chosen};
  return {"python3", "/usr/bin/python3"};
}

}  // namespace

PythonRun run_python(std::vector<std::string> arguments, int lacks, const std::string& input,
                     PythonErrors errors, const std::filesystem::path& folder) {
  arguments.insert(arguments.begin(), "");
  PythonRun run;
  for (const std::string& python : python_interpreters()) {
    arguments.front() = python;
    run = run_program(arguments, input, errors, folder);
    if (run.exit_code != kPythonNotFound && run.exit_code != lacks) break;
  }
  return run;
}

}  // namespace spool::tools
