// The rule of `meta` records: one JSON object (formats/spool.md 4.4).
#pragma once

#include <string_view>

#include "formats/violation.h"

namespace spool::format {

Judged<void> check_meta(std::string_view text);

}  // namespace spool::format
