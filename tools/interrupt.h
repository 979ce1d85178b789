// Ctrl-C and SIGTERM: unfinished files are removed, one line is printed, the exit code is 128 plus
// the signal's number, as a shell expects.
#pragma once

namespace spool::tools {

// Call once, before any other thread exists: they inherit the blocked signals, and one thread of
// its own waits for them, so that the way out may do more than a signal handler is allowed to.
void watch_for_interrupts();

}  // namespace spool::tools
