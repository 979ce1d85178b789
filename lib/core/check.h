// Precondition checks of numeric code: always on, and they print both values.
//
// A failed check is a programming error, never a user's: input from files and people is refused
// earlier, as an Error value (error.h). It ends the program; where a failed call must not take the
// process with it, as in an interpreter, it is an exception.
#pragma once

#include <string>

#include <fmt/core.h>

namespace spool {

// From now on a failed check of this process throws std::logic_error with its line.
void throw_failed_checks();

[[noreturn]] void check_failed(const char* file, int line, const std::string& what);

}  // namespace spool

#define SPOOL_CHECK(condition)                                               \
  do {                                                                       \
    if (!(condition)) ::spool::check_failed(__FILE__, __LINE__, #condition); \
  } while (false)

#define SPOOL_CHECK_OP(a, op, b)                                                     \
  do {                                                                               \
    const auto& check_a_ = (a);                                                      \
    const auto& check_b_ = (b);                                                      \
    if (!(check_a_ op check_b_)) {                                                   \
      ::spool::check_failed(                                                         \
          __FILE__, __LINE__,                                                        \
          fmt::format("{} {} {} ({} against {})", #a, #op, #b, check_a_, check_b_)); \
    }                                                                                \
  } while (false)

#define SPOOL_CHECK_EQ(a, b) SPOOL_CHECK_OP(a, ==, b)
#define SPOOL_CHECK_LE(a, b) SPOOL_CHECK_OP(a, <=, b)
#define SPOOL_CHECK_LT(a, b) SPOOL_CHECK_OP(a, <, b)
#define SPOOL_CHECK_GE(a, b) SPOOL_CHECK_OP(a, >=, b)
#define SPOOL_CHECK_GT(a, b) SPOOL_CHECK_OP(a, >, b)
