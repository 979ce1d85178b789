#include "tools/terminal/text_columns.h"

#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <clocale>
#include <cwchar>
#include <ranges>
#include <sstream>
#include <utility>

#include "lib/core/visible_text.h"

namespace spool::tools {
namespace {

constexpr std::size_t kNarrowest = 20;      // characters: in less nothing is laid out
constexpr std::size_t kNarrowestFirst = 4;  // a column whose longer cells have lines of their own
constexpr std::size_t kIndent = 4;          // of what stands below its entry
constexpr const char* kBetween = "  ";

using Rows = std::vector<std::vector<std::string>>;
using Widths = std::vector<std::size_t>;

std::string padding(std::size_t width, std::string_view text) {
  return std::string(width - std::min(width, column_count(text)), ' ');
}

std::size_t sum_of(const Widths& widths) {
  std::size_t sum = 2 * (widths.size() - 1);
  for (const std::size_t width : widths)
    sum += width;
  return sum;
}

bool is_heading(const std::vector<std::string>& row, const Rows& rows) {
  return row.size() == 1 && rows.front().size() > 1;
}

Widths widths_of(const Rows& rows) {
  Widths widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size() && !is_heading(row, rows); ++i)
      widths[i] = std::max(widths[i], column_count(row[i]));
  }
  return widths;
}

// What the columns of text may have so that all fit, the widest first made narrower.
Widths fitted(Widths widths, std::size_t first_number, std::size_t width) {
  const auto text_end = widths.begin() + static_cast<long>(std::min(first_number, widths.size()));
  while (width > 0 && sum_of(widths) > width) {
    const auto widest = std::max_element(widths.begin(), text_end);
    const std::size_t least = widest == widths.begin() ? kNarrowestFirst : kNarrowest;
    if (widest == text_end || *widest <= least) break;
    const std::size_t excess = sum_of(widths) - width;
    *widest = std::max(least, *widest - std::min(*widest, excess));
  }
  return widths;
}

std::vector<std::string> lines_of(const std::string& cell, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream text(column_count(cell) > width ? wrapped(cell, width) : cell);
  for (std::string line; std::getline(text, line);)
    lines.push_back(line);
  return lines;
}

std::string row_text(const std::vector<std::string>& row, const Widths& widths,
                     std::size_t first_number, std::size_t width) {
  std::string text;
  std::vector<std::vector<std::string>> cells;
  std::size_t height = 1;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const bool above = i == 0 && column_count(row[i]) > widths[i];
    if (above) text += wrapped(row[i], width, 2) + "\n";
    cells.push_back(above ? std::vector<std::string>{} : lines_of(row[i], widths[i]));
    height = std::max(height, cells.back().size());
  }
  for (std::size_t y = 0; y < height; ++y) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string cell = y < cells[i].size() ? cells[i][y] : "";
      const std::string space = padding(widths[i], cell);
      line += (i > 0 ? kBetween : "") + (i < first_number ? cell + space : space + cell);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

// "NAME: allowed; default=value" and, below, what it means.
std::string entry_text(const std::vector<std::string>& header, const std::vector<std::string>& row,
                       std::size_t width) {
  std::string text = row.front() + ": " + row[1];
  for (std::size_t i = 2; i + 1 < row.size(); ++i)
    text += "; " + header[i] + "=" + row[i];
  const std::string below(text.find_first_not_of(' ') + kIndent, ' ');
  return wrapped(text, width, kIndent) + "\n" + wrapped(below + row.back(), width) + "\n";
}

}  // namespace

std::size_t line_width(int descriptor) {
  winsize size{};
  if (::isatty(descriptor) != 1) return 0;
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col >= kNarrowest ? size.ws_col : 0;
}

std::size_t column_count(std::string_view text) {
  static const locale_t utf8 = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  if (utf8 == nullptr) return text.size();
  const locale_t before = ::uselocale(utf8);
  std::mbstate_t state{};
  std::size_t columns = 0;
  while (!text.empty()) {
    wchar_t character = 0;
    const std::size_t bytes = std::mbrtowc(&character, text.data(), text.size(), &state);
    const bool known = bytes > 0 && bytes <= text.size();  // else no UTF-8
    const int width = known ? ::wcwidth(character) : 1;
    columns += static_cast<std::size_t>(width >= 0 ? width : 1);
    text.remove_prefix(known ? bytes : 1);
    if (!known) state = {};
  }
  ::uselocale(before);
  return columns;
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  if (width == 0) return std::string(text);
  std::string result;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    const std::size_t start = std::min(line.find_first_not_of(' '), line.size());
    const bool fits = column_count(line) <= width;
    std::istringstream words{std::string(fits ? "" : line.substr(start))};
    std::size_t used = start;
    result += fits ? line : line.substr(0, start);
    bool first = true;
    for (std::string word; words >> word; first = false) {
      const std::size_t length = column_count(word);
      if (!first && used + 1 + length > width) {
        result += "\n" + std::string(start + indent, ' ');
        used = start + indent;
      } else if (!first) {
        result += " ";
        ++used;
      }
      result += word;
      used += length;
    }
    text.remove_prefix(line.size());
    if (text.empty()) break;
    result += "\n";
    text.remove_prefix(1);
  }
  return result;
}

std::string format_columns(const Rows& rows, std::size_t first_number, std::size_t width) {
  Rows shown = rows;
  for (auto& row : shown)
    for (std::string& cell : row)
      cell = visible_text(cell);
  const Widths widths = fitted(widths_of(shown), first_number, width);
  std::string text;
  for (const auto& row : shown)
    text += is_heading(row, shown) ? wrapped(row.front(), width, 2) + "\n"
                                   : row_text(row, widths, first_number, width);
  return text;
}

std::string format_entries(const Rows& rows, std::size_t width) {
  Widths widths = widths_of(rows);
  const std::size_t last = std::exchange(widths.back(), 0), beside = sum_of(widths);
  std::string text;
  if (width > 0 && beside + std::min(last, kNarrowest) > width) {
    text = wrapped(rows.front().front(), width) + "\n";
    for (const auto& row : rows | std::views::drop(1))
      text += entry_text(rows.front(), row, width);
    return text;
  }
  widths.back() = width > 0 ? std::min(last, width - beside) : last;
  for (const auto& row : rows)
    text += row_text(row, widths, row.size(), width);
  return text;
}

}  // namespace spool::tools
