// The error value of everything that can fail because of a file, a person or the machine.
//
// One Error is one line on stderr: what is wrong, where, and what to do. `code` is the exit code of
// the program. No exception crosses the edge of a module; functions return Result<T>.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <tl/expected.hpp>

namespace spool {

// Exit codes of the program. 0 is success.
enum class ErrorCode : int {
  kData = 1,   // the data can be read but not used (wrong format, wrong contents, too small a pool)
  kUsage = 2,  // wrong use: unknown name, option out of range, target exists
  kIo = 3,     // the operating system refused: missing, unreadable, disk full
  kDamage = 4,  // the file is damaged or incomplete
};

struct Error {
  ErrorCode code = ErrorCode::kData;
  std::string message;  // "FILE: what (where): what to do"
};

template <class T>
using Result = tl::expected<T, Error>;

// Control characters made visible: names and texts that come from files may hold anything, and a
// terminal obeys some of it. Other alphabets stay as they are.
inline std::string one_line(std::string text) {
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = byte == '\n' || byte == '\t' ? ' ' : '?';
  }
  return text;
}

template <class... Args>
tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected<Error>(
      Error{code, one_line(fmt::format(format, std::forward<Args>(args)...))});
}

}  // namespace spool

// Evaluates `expression` (a Result<void>); returns its error from the enclosing function, if any.
#define SPOOL_TRY(expression)                                                \
  do {                                                                       \
    if (auto try_result_ = (expression); !try_result_.has_value())           \
      return tl::unexpected<::spool::Error>(std::move(try_result_).error()); \
  } while (false)

#define SPOOL_CONCAT_INNER(a, b) a##b
#define SPOOL_CONCAT(a, b) SPOOL_CONCAT_INNER(a, b)

// NOLINTBEGIN(bugprone-macro-parentheses): `variable` may be a declaration.
// Declares `variable` from a Result; returns the error from the enclosing function, if any.
#define SPOOL_ASSIGN(variable, expression) \
  SPOOL_ASSIGN_INNER(variable, expression, SPOOL_CONCAT(assign_result_, __LINE__))
#define SPOOL_ASSIGN_INNER(variable, expression, temporary)                                        \
  auto temporary = (expression);                                                                   \
  if (!temporary.has_value()) return tl::unexpected<::spool::Error>(std::move(temporary).error()); \
  variable = std::move(*temporary)
// NOLINTEND(bugprone-macro-parentheses)
