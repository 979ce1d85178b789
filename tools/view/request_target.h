// What the address of a request says, taken apart: "/TOKEN/name?parameter=value&...".
#pragma once

#include <string>
#include <string_view>

namespace spool::tools {

struct RequestTarget {
  std::string token;
  std::string name;        // as sent: no name that is served needs an escape
  std::string parameters;  // what follows the question mark, as sent
};

RequestTarget parse_target(std::string_view target);

// The first value of that name, its %XX replaced.
std::string parameter_of(std::string_view parameters, std::string_view name);

}  // namespace spool::tools
