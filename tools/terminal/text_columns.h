// Text as wide as the terminal that it goes to: paragraphs and tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spool::tools {

// Characters of a line of the terminal on `descriptor` (stdout); 0 where that is a file or a pipe,
// whose text does not depend on anyone's window.
std::size_t line_width(int descriptor = 1);
// Columns that a text takes there: an ideograph two, a combining mark none.
std::size_t column_count(std::string_view text);

// Each line of `text` in lines of at most `width` characters, broken between words; those after its
// first begin below it, `indent` further in. Words are left whole. With a width of 0 nothing
// changes.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent = 0);

// Text in columns: the first row is the header; numbers (columns >= `first_number`) to the right.
// Cells are one line each, whatever they hold. Where the lines would be longer than `width`, the
// widest columns of text are wrapped, and a first cell that is too long gets lines of its own. A
// row of one cell is a heading over all columns.
std::string format_columns(const std::vector<std::vector<std::string>>& rows,
                           std::size_t first_number, std::size_t width = line_width());

// A list of options or the like: in columns, of which the last is wrapped; where that leaves it no
// room, an entry below the other.
std::string format_entries(const std::vector<std::vector<std::string>>& rows,
                           std::size_t width = line_width());

}  // namespace spool::tools
