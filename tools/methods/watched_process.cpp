#include "tools/methods/watched_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <thread>

extern char** environ;

namespace spool::tools {
namespace {

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

// Signals are as a shell would have them.
void put_into_group(posix_spawnattr_t& attributes, pid_t group) {
  sigset_t none, defaults;
  sigemptyset(&none);  // this program blocks the signals that it waits for, in all its threads
  sigemptyset(&defaults);
  for (const int signal : {SIGPIPE, SIGHUP, SIGINT, SIGQUIT, SIGTERM})
    sigaddset(&defaults, signal);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setpgroup(&attributes, group);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
}

// What the new process does with its streams.
class StreamActions {
 public:
  explicit StreamActions(const Streams& streams) {
    if (::posix_spawn_file_actions_init(&actions_) != 0) return;
    made_ = true;
    lead(streams.in, STDIN_FILENO, O_RDONLY);
    lead(streams.out, STDOUT_FILENO, O_WRONLY);
    lead(streams.error >= 0 ? streams.error : STDOUT_FILENO, STDERR_FILENO, O_WRONLY);
    if (!streams.others) ::posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  StreamActions(const StreamActions&) = delete;
  StreamActions& operator=(const StreamActions&) = delete;
  ~StreamActions() {
    if (made_) ::posix_spawn_file_actions_destroy(&actions_);
  }

  const posix_spawn_file_actions_t* get() const { return made_ ? &actions_ : nullptr; }

 private:
  void lead(int from, int to, int mode) {
    if (from >= 0) {
      ::posix_spawn_file_actions_adddup2(&actions_, from, to);
    } else {
      ::posix_spawn_file_actions_addopen(&actions_, to, "/dev/null", mode, 0);
    }
  }

  posix_spawn_file_actions_t actions_;
  bool made_ = false;
};

// In the process group `group`; 0: it leads one of its own, which an interrupt ends.
int spawn(std::vector<std::string> words, const Streams& streams, pid_t group, char** environment,
          pid_t& child) {
  const StreamActions actions(streams);
  posix_spawnattr_t attributes;
  if (actions.get() == nullptr || posix_spawnattr_init(&attributes) != 0) return ENOMEM;
  put_into_group(attributes, group);
  std::vector<char*> pointers;
  for (std::string& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::scoped_lock lock(running().mutex);  // an interrupt knows it from its first moment on
  const int status = posix_spawnp(&child, pointers[0], actions.get(), &attributes, pointers.data(),
                                  environment != nullptr ? environment : environ);
  if (status == 0 && group == 0) running().groups.insert(child);
  posix_spawnattr_destroy(&attributes);
  return status;
}

// Leads a group, and waits for the end of a pipe that this program holds.
constexpr const char* kGuard =
    "trap '' TERM; read nothing; kill -TERM 0; sleep 0.1; rm -rf -- \"$1\"; kill -KILL 0";

}  // namespace

int WatchedGroup::start_guard() {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return errno;
  const int error =
      spawn({"/bin/sh", "-c", kGuard, "sh", folder_.string()}, {.in = pipe[0]}, 0, nullptr, guard_);
  ::close(pipe[0]);
  lifeline_ = pipe[1];
  if (error != 0) ::close(lifeline_);
  return error;
}

int WatchedGroup::start(std::vector<std::string> words, const Streams& streams, char** environment,
                        pid_t& child) {
  if (const int error = guard_ == 0 ? start_guard() : 0; error != 0) return error;
  return spawn(std::move(words), streams, guard_, environment, child);
}

void WatchedGroup::end() {
  if (guard_ == 0) return;
  const std::scoped_lock lock(running().mutex);  // an interrupt ends it in its own way
  ::kill(-guard_, SIGKILL);
  int ignored = 0;
  while (::waitpid(guard_, &ignored, 0) < 0 && errno == EINTR) {
  }
  ::close(lifeline_);
  running().groups.erase(std::exchange(guard_, 0));
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
  // For good: the thread that waits for a command must not take its end for a failure of the
  // command and leave with another exit code first.
  running().mutex.lock();
  for (const pid_t group : running().groups)
    ::kill(-group, SIGTERM);
  // As the guards do: Python's own guard removes the semaphores of a pool when all else has ended.
  if (!running().groups.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  for (const pid_t group : running().groups)
    ::kill(-group, SIGKILL);
  std::error_code ignored;
  // Where a worker's guard removes a folder inside at the same time, a removal stops early.
  for (const std::string& folder : running().folders) {
    for (int i = 0; i < 100 && std::filesystem::exists(folder, ignored); ++i) {
      std::filesystem::remove_all(folder, ignored);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

}  // namespace spool::tools
