// JSON as the program prints it.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace spool::tools {

// With a line end. Strings that are not UTF-8 (names of files may be anything) have the bytes that
// are none as \xff, as on the terminal.
std::string json_text(const nlohmann::ordered_json& value);

nlohmann::ordered_json json_number(double value);  // null where not finite

}  // namespace spool::tools
