// A command of a user, run by /bin/sh and watched: its end, its time, its last words.
//
// The command is a process group of its own, killed as a whole when it takes too long, when the
// caller gives up, or when this program is interrupted or killed; nothing that it started outlives
// the call. Of what it prints, the end is kept.
#pragma once

#include <spawn.h>
#include <sys/types.h>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

struct ExternalCommand {
  std::string command;                 // a line for /bin/sh; the arguments are put after it
  std::vector<std::string> arguments;  // handed over as they are, never read by the shell
  std::vector<std::pair<std::string, std::string>> environment;  // added to this program's own
  double timeout = 600.0;                                        // seconds
  std::filesystem::path folder;          // goes with this program, should that be killed
  std::function<bool()> cancelled = {};  // asked while it runs; may be empty
};

// Seconds from its start until it opened the first of its arguments, which is a file: the time of
// the shell, an interpreter and its imports. The whole time where it opened none.
struct ExternalTimes {
  double start = 0;
};

// Errors name the command: kData when it fails (with the last line it printed), when it does not
// end in time or is cancelled; kIo when it cannot be started.
Result<ExternalTimes> run_external(const ExternalCommand& command);

// A temporary folder that goes when this goes, or when the program is interrupted.
class ExchangeFolder {
 public:
  static Result<ExchangeFolder> create();
  ExchangeFolder(ExchangeFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ExchangeFolder(const ExchangeFolder&) = delete;
  ExchangeFolder& operator=(const ExchangeFolder&) = delete;
  ExchangeFolder& operator=(ExchangeFolder&&) = delete;
  ~ExchangeFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  explicit ExchangeFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

// Another program of our own choice, in a group that an interrupt ends too: `spawn` starts it with
// the attributes it is given and puts its id into `child`. False when it does not start.
bool start_watched(const std::function<int(const posix_spawnattr_t&)>& spawn, const pid_t& child);
void forget_watched(pid_t child);  // when it has ended

// Kills running commands and removes their folders: for the program's way out on an interrupt.
// Threads that wait for a command then wait for the end of the process.
void end_external_work();

}  // namespace spool::tools
