// Ctrl-C, SIGTERM, SIGQUIT and the end of the terminal (SIGHUP): unfinished files are removed, one
// line is printed, the exit code is 128 plus the signal's number, as a shell expects.
#pragma once

#include <functional>
#include <string>

namespace spool::tools {

// Call once, before any other thread exists: they inherit the blocked signals, and one thread of
// its own waits for them, so that the way out may do more than a signal handler is allowed to.
void watch_for_interrupts();

// While it lives, the line printed on an interrupt ends with what `text` returns: what was kept and
// how to go on. Called on the thread that waits for signals.
class InterruptNote {
 public:
  explicit InterruptNote(std::function<std::string()> text);
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;
};

}  // namespace spool::tools
