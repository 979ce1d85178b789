// A command of somebody else, run by /bin/sh and watched: its end, its time, its last words.
//
// The command is a process group of its own, killed as a whole when it takes too long, when the
// caller gives up, or when this program is interrupted; nothing that it started outlives the call.
#pragma once

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
  std::filesystem::path log;             // takes what it prints on stdout and stderr
  std::function<bool()> cancelled = {};  // asked while it runs; may be empty
};

// Errors name the command: kData when it fails (with the last line it printed), when it does not
// end in time or is cancelled; kIo when it cannot be started.
Result<void> run_external(const ExternalCommand& command);

// A temporary folder that goes when this goes, or when the program is interrupted.
class ExchangeFolder {
 public:
  static Result<ExchangeFolder> create();
  ExchangeFolder(ExchangeFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ExchangeFolder(const ExchangeFolder&) = delete;
  ExchangeFolder& operator=(const ExchangeFolder&) = delete;
  ExchangeFolder& operator=(ExchangeFolder&&) = delete;
  ~ExchangeFolder();

  std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  explicit ExchangeFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

// Kills running commands and removes their folders: for the program's way out on an interrupt.
void end_external_work();

}  // namespace spool::tools
