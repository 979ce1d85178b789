// A command of a user, run by /bin/sh and watched: its end, its time, its last words.
//
// The command is a process group of its own, killed as a whole when it takes too long, when the
// work that it is part of is stopped, or when this program is interrupted or killed; nothing that
// it started outlives the call. Of what it prints, the end is kept.
#pragma once

#include <filesystem>
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
  std::filesystem::path folder;  // goes with this program, should that be killed
};

// Seconds from its start until it opened the first of its arguments, which is a file: the time of
// the shell, an interpreter and its imports. The whole time where it opened none.
struct ExternalTimes {
  double start = 0;
};

// Errors name the command: kData when it fails (with the last line it printed), when it does not
// end in time; kIo when it cannot be started. Throws WorkStopped (lib/core/parallel.h).
Result<ExternalTimes> run_external(const ExternalCommand& command);

}  // namespace spool::tools
