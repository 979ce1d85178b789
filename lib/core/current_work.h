// The stoppable work that a thread does part of: threads of one's own join it (worker_threads.cpp).
#pragma once

namespace spool {

class StoppableWork;

// What this thread runs now (StoppableWork::run), or null.
StoppableWork* current_work();

// Whether that work was stopped: for what waits outside of its loops.
bool is_stopped();

}  // namespace spool
