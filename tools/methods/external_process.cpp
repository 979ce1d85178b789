#include "tools/methods/external_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <sstream>
#include <thread>

#include "lib/core/current_work.h"
#include "lib/core/parallel.h"
#include "lib/core/visible_text.h"
#include "tools/methods/watched_process.h"

extern char** environ;

namespace spool::tools {
namespace {

constexpr std::size_t kLongestWords = 200;  // of a command's last line in an error
constexpr int kSignalBase = 128;            // a shell's exit code for signal n is 128 + n
constexpr std::size_t kLogTail = 4096;      // bytes of its output that are kept
constexpr int kLastReads = 16;              // of what a pipe holds when the command has ended

// The end of what a command prints, read while it runs: it may print without end.
class LastWords {
 public:
  explicit LastWords(int descriptor) : descriptor_(descriptor) {}
  ~LastWords() { ::close(descriptor_); }
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;

  // Takes what is there, or waits at most so long for something; false when no more can come.
  bool read(std::chrono::milliseconds wait) {
    pollfd waiting{descriptor_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(wait.count())) <= 0) return true;
    std::array<char, 65536> buffer{};
    const ssize_t n = ::read(descriptor_, buffer.data(), buffer.size());
    if (n < 0) return errno == EAGAIN || errno == EINTR;
    tail_.append(buffer.data(), static_cast<std::size_t>(n));
    if (tail_.size() > kLogTail) tail_.erase(0, tail_.size() - kLogTail);
    return n > 0;
  }

  // The last line, fit for one line of an error; or nothing.
  std::string line() const {
    std::istringstream stream(tail_);
    std::string line, last;
    while (std::getline(stream, line)) {
      if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    }
    for (char& c : last) {
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
    }
    if (last.size() <= kLongestWords) return last;
    return last.substr(0, start_of_character(last, kLongestWords)) + "...";
  }

 private:
  int descriptor_;
  std::string tail_;
};

// Environment of this program with some variables replaced.
class Environment {
 public:
  explicit Environment(const std::vector<std::pair<std::string, std::string>>& added) {
    for (char** variable = environ; *variable != nullptr; ++variable) {
      const std::string_view text = *variable;
      const std::string_view name = text.substr(0, text.find('='));
      bool replaced = false;
      for (const auto& [key, value] : added)
        replaced = replaced || key == name;
      if (!replaced) texts_.emplace_back(text);
    }
    for (const auto& [key, value] : added)
      texts_.push_back(fmt::format("{}={}", key, value));
    for (std::string& text : texts_)
      pointers_.push_back(text.data());
    pointers_.push_back(nullptr);
  }
  char** pointers() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

// A command at work.
struct Command {
  explicit Command(const std::filesystem::path& folder) : group(folder) {}
  WatchedGroup group;
  pid_t child = 0;
  int output = -1;  // what the command prints
};

// An error number of the system when the command cannot be started.
int start(const ExternalCommand& command, Command& started) {
  std::array<int, 2> output{};
  if (::pipe2(output.data(), O_CLOEXEC) != 0) return errno;
  Environment environment(command.environment);
  std::vector<std::string> words = {"/bin/sh", "-c", command.command + " \"$@\"", "sh"};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  const int error = started.group.start(std::move(words), {.out = output[1]},
                                        environment.pointers(), started.child);
  ::close(output[1]);
  if (error != 0) {
    ::close(output[0]);
    return error;
  }
  started.output = output[0];
  ::fcntl(started.output, F_SETFL, O_NONBLOCK);
  return 0;
}

// Whether a file has been opened since this was made; never where the system cannot say.
class OpenWatch {
 public:
  explicit OpenWatch(const std::string& path) : file_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    if (file_ >= 0) ::inotify_add_watch(file_, path.c_str(), IN_OPEN);
  }
  OpenWatch(const OpenWatch&) = delete;
  OpenWatch& operator=(const OpenWatch&) = delete;
  ~OpenWatch() {
    if (file_ >= 0) ::close(file_);
  }

  bool opened() const {
    std::array<char, 4096> events;
    return file_ >= 0 && ::read(file_, events.data(), events.size()) > 0;
  }

 private:
  int file_;
};

enum class Ending { kByItself, kTimeout, kStopped };

Ending wait_for(Command& running, const ExternalCommand& command, const OpenWatch& watch,
                LastWords& words, int& status, ExternalTimes& times) {
  using Clock = std::chrono::steady_clock;
  const auto start_time = Clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(Clock::now() - start_time).count();
  };
  bool started = false;
  auto pause = std::chrono::milliseconds(1);
  Ending ending = Ending::kByItself;
  // WNOWAIT leaves the child's number taken until its group has been killed.
  siginfo_t info{};
  bool printing = true;
  while (true) {
    info.si_pid = 0;
    if (waitid(P_PID, static_cast<id_t>(running.child), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
      break;
    if (info.si_pid == running.child) break;
    if (!started) {
      started = watch.opened();
      times.start = elapsed();
    }
    if (elapsed() > command.timeout) {
      ending = Ending::kTimeout;
      break;
    }
    if (is_stopped()) {
      ending = Ending::kStopped;
      break;
    }
    if (printing) {
      printing = words.read(pause);
    } else {
      std::this_thread::sleep_for(pause);  // it has closed its output and goes on
    }
    if (started) pause = std::min(2 * pause, std::chrono::milliseconds(20));
  }
  // What is in the pipe when it ends, and no more: what it left behind may go on printing.
  for (int i = 0; i < kLastReads && printing; ++i)
    printing = words.read(std::chrono::milliseconds(0));
  running.group.end();  // and what the command left behind
  while (::waitpid(running.child, &status, 0) < 0 && errno == EINTR) {
  }
  return ending;
}

}  // namespace

Result<ExternalTimes> run_external(const ExternalCommand& command) {
  Command running(command.folder);
  ExternalTimes times;
  const OpenWatch watch(command.arguments.empty() ? std::string() : command.arguments.front());
  if (const int error = start(command, running); error != 0) {
    return fail(ErrorCode::kIo, "exec:{}: cannot be started: {}", command.command,
                std::strerror(error));
  }
  LastWords printed(running.output);
  int status = 0;
  const Ending ending = wait_for(running, command, watch, printed, status, times);
  if (ending == Ending::kStopped) throw WorkStopped{};
  if (ending == Ending::kTimeout) {
    return fail(ErrorCode::kData,
                "exec:{}: no answer within {} s: mend it, or give it more time with the option "
                "timeout",
                command.command, command.timeout);
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : kSignalBase + WTERMSIG(status);
  const bool by_signal = code > kSignalBase && code <= kSignalBase + SIGRTMAX;
  if (code == 0) return times;
  const std::string words = printed.line();
  return fail(
      ErrorCode::kData, "exec:{}: {} {}{}", command.command,
      by_signal ? "was ended by signal" : "failed with exit code",
      by_signal ? code - kSignalBase : code,
      words.empty() ? ": it printed nothing; run it by hand" : ", its last words: " + words);
}

}  // namespace spool::tools
