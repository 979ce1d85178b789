// Processes that this program starts, and the folders that it exchanges files with them in: an
// interrupt ends the first and removes the second.
#pragma once

#include <sys/types.h>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

// What a process gets as its standard streams: descriptors. -1: /dev/null, for errors that of
// `out`.
struct Streams {
  int in = -1, out = -1, error = -1;
  bool others = false;  // what else this program was handed: a process of MPI needs it
};

// A group of processes that ends with this object, with an interrupt, and should this program be
// killed, whatever the signal: then `folder` goes, too.
class WatchedGroup {
 public:
  explicit WatchedGroup(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}
  WatchedGroup(const WatchedGroup&) = delete;
  WatchedGroup& operator=(const WatchedGroup&) = delete;
  ~WatchedGroup() { end(); }

  // Starts a program, `words[0]` (of the path, where it has no slash). Signals are as a shell would
  // have them. `environment`: null: that of this program. An error number of the system when it
  // cannot be started.
  int start(std::vector<std::string> words, const Streams& streams, char** environment,
            pid_t& child);
  // Kills what is left of it. Who started a program waits for it.
  void end();

 private:
  int start_guard();

  std::filesystem::path folder_;
  pid_t guard_ = 0;
  int lifeline_ = -1;  // the end of a pipe that is never written to
};

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

// Kills running commands and removes their folders: for the program's way out on an interrupt.
// Threads that wait for a command then wait for the end of the process.
void end_external_work();

}  // namespace spool::tools
