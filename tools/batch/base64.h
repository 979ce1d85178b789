// Bytes as text of 64 letters [RFC 4648, 4], with padding.
#pragma once

#include <string>
#include <string_view>

namespace spool::tools {

std::string to_base64(std::string_view bytes);
// Empty where the text is no base64.
std::string from_base64(std::string_view text);

}  // namespace spool::tools
