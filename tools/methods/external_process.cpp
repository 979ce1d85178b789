#include "tools/methods/external_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

extern char** environ;

namespace spool::tools {
namespace {

constexpr std::size_t kLongestWords = 200;  // of a command's last line in an error
constexpr int kSignalBase = 128;            // a shell's exit code for signal n is 128 + n
constexpr std::streamoff kLogTail = 4096;   // bytes of its output that are looked at

// What an interrupt must end and remove.
struct Running {
  std::mutex mutex;
  std::set<pid_t> groups;
  std::set<std::string> folders;
};

Running& running() {
  static Running instance;
  return instance;
}

// The last line that the command printed, fit for one line of an error; or nothing.
std::string last_words(const std::filesystem::path& log) {
  std::ifstream stream(log, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
  stream.seekg(std::max<std::streamoff>(0, size - kLogTail));
  std::string line, last;
  while (std::getline(stream, line)) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  for (char& c : last) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  if (last.size() > kLongestWords) last = last.substr(0, kLongestWords) + "...";
  return last;
}

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
      texts_.push_back(key + "=" + value);
    for (std::string& text : texts_)
      pointers_.push_back(text.data());
    pointers_.push_back(nullptr);
  }
  char** pointers() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

// Starts the command in a group of its own; an error number of the system when that fails.
int start(const ExternalCommand& command, pid_t& child) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  if (posix_spawn_file_actions_init(&files) != 0) return ENOMEM;
  if (posix_spawnattr_init(&attributes) != 0) {
    posix_spawn_file_actions_destroy(&files);
    return ENOMEM;
  }
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, command.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  sigset_t none, defaults;
  sigemptyset(&none);  // this program blocks SIGINT and SIGTERM for all its threads
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

  std::vector<std::string> words = {"sh", "-c", command.command + " \"$@\"", "sh"};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  Environment environment(command.environment);
  const std::scoped_lock lock(running().mutex);  // an interrupt sees it from its first moment on
  const int status =
      posix_spawn(&child, "/bin/sh", &files, &attributes, pointers.data(), environment.pointers());
  if (status == 0) running().groups.insert(child);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return status;
}

enum class Ending { kByItself, kTimeout, kCancelled };

Ending wait_for(pid_t child, const ExternalCommand& command, int& status) {
  using Clock = std::chrono::steady_clock;
  const auto start_time = Clock::now();
  auto pause = std::chrono::microseconds(500);
  Ending ending = Ending::kByItself;
  // WNOWAIT leaves the child's number taken until its group has been killed.
  siginfo_t info{};
  while (true) {
    info.si_pid = 0;
    if (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0) break;
    if (info.si_pid == child) break;
    if (std::chrono::duration<double>(Clock::now() - start_time).count() > command.timeout) {
      ending = Ending::kTimeout;
      break;
    }
    if (command.cancelled && command.cancelled()) {
      ending = Ending::kCancelled;
      break;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::microseconds(20000));
  }
  ::kill(-child, SIGKILL);  // and what it left behind
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::scoped_lock lock(running().mutex);
  running().groups.erase(child);
  return ending;
}

}  // namespace

Result<void> run_external(const ExternalCommand& command) {
  pid_t child = 0;
  if (const int error = start(command, child); error != 0) {
    return fail(ErrorCode::kIo, "exec:{}: cannot be started: {}", command.command,
                std::strerror(error));
  }
  int status = 0;
  const Ending ending = wait_for(child, command, status);
  if (ending == Ending::kTimeout) {
    return fail(ErrorCode::kData,
                "exec:{}: no answer within {} s: mend it, or give it more time with the option "
                "timeout",
                command.command, command.timeout);
  }
  if (ending == Ending::kCancelled) {
    return fail(ErrorCode::kData, "exec:{}: cancelled", command.command);
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : kSignalBase + WTERMSIG(status);
  if (code == 0) return {};
  const std::string words = last_words(command.log);
  return fail(
      ErrorCode::kData, "exec:{}: {} {}{}", command.command,
      code > kSignalBase ? "was ended by signal" : "failed with exit code",
      code > kSignalBase ? code - kSignalBase : code,
      words.empty() ? ": it printed nothing; run it by hand" : ", its last words: " + words);
}

Result<ExchangeFolder> ExchangeFolder::create() {
  std::error_code status;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(status);
  if (status) {
    return fail(ErrorCode::kIo, "no folder for temporary files ({}): set TMPDIR", status.message());
  }
  std::string name = (parent / "spool_XXXXXX").string();
  const std::scoped_lock lock(running().mutex);
  if (::mkdtemp(name.data()) == nullptr) {
    return fail(ErrorCode::kIo, "{}: no folder can be made there ({}): set TMPDIR", parent.string(),
                std::strerror(errno));
  }
  running().folders.insert(name);
  return ExchangeFolder(name);
}

ExchangeFolder::~ExchangeFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  const std::scoped_lock lock(running().mutex);
  running().folders.erase(path_.string());
}

void end_external_work() {
  const std::scoped_lock lock(running().mutex);
  for (const pid_t group : running().groups)
    ::kill(-group, SIGKILL);
  std::error_code ignored;
  for (const std::string& folder : running().folders)
    std::filesystem::remove_all(folder, ignored);
}

}  // namespace spool::tools
