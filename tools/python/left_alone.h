// A function of one's own, called where it can be left alone.
#pragma once

#include <memory>

#include "tools/python/running.h"

namespace spool::python {

// What `ask` of the function returns or raises, from a thread of its own; with the interpreter's
// lock. Throws WorkStopped where `watch` (null: none) was stopped and the function waits where no
// exception reaches it: it is left to itself, and what comes of it is dropped.
nb::object answer_to(nb::object told, const nb::object& function,
                     const std::shared_ptr<Watch>& watch);

}  // namespace spool::python
