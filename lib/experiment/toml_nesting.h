// How deep a TOML text nests, before a parser reads it.
//
// toml++ bounds the depth of arrays and inline tables, but makes a table in a table for every part
// of a dotted key, and frees them by recursion: a line of 50,000 parts ends its stack.
#pragma once

#include <cstddef>
#include <string_view>

namespace spool {

inline constexpr std::size_t kMaxTomlDepth = 32;  // of brackets; and parts of a key
inline constexpr std::size_t kMaxTomlBytes = std::size_t{8} << 20;

// The line of the first bracket or key that is deeper than `limit`; 0 when there is none.
// Brackets and dots in strings and comments do not count. Numbers with a fraction count as keys of
// two parts, which is far below the limit.
std::size_t line_nested_too_deeply(std::string_view text, std::size_t limit = kMaxTomlDepth);

}  // namespace spool
