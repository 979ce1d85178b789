// Bytes of a text that are written as %XX.
#pragma once

#include <string>
#include <string_view>

namespace spool {

// %XX as the byte it stands for; what is no such escape stays as it is.
std::string percent_decoded(std::string_view text);

}  // namespace spool
