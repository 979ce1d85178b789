// Text from files made fit for a terminal and for JSON: nothing in it is obeyed, nothing is hidden.
#pragma once

#include <string>
#include <string_view>

namespace spool {

// Control characters (C0, DEL, C1), line separators and what turns the direction of writing around
// become escapes as JSON has them (\n, \u001b); bytes that are no UTF-8 become \xff. What is left
// is one line of valid UTF-8. `keep_lines` lets '\n' pass, for text of several lines of our own.
std::string visible_text(std::string_view text, bool keep_lines = false);

// As printable ASCII: every other byte becomes '?'.
std::string printable_ascii(std::string_view text);

// As a shell takes it for one word: in single quotes where it needs them.
std::string shell_word(std::string_view text);
std::string shell_quoted(std::string_view text);  // always: 'it'\''s'

// Where the character begins that has the byte `at`: to cut a text there.
std::size_t start_of_character(std::string_view text, std::size_t at);

// Whether every byte belongs to a character.
bool is_utf8(std::string_view text);

}  // namespace spool
