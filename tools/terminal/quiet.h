// Whether remarks are printed: --quiet of every verb.
#pragma once

namespace spool::tools {

// From now on print_note() (console.h) prints nothing.
void keep_quiet();

}  // namespace spool::tools
