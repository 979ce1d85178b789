// Precondition checks of numeric code: always on, and they print both values.
//
// A failed check is a programming error, never a user's: input from files and people is refused
// earlier, as an Error value (error.h).
#pragma once

#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>

#define SPOOL_CHECK(condition)                                                         \
  do {                                                                                 \
    if (!(condition)) {                                                                \
      fmt::print(stderr, "{}:{}: check failed: {}\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                    \
    }                                                                                  \
  } while (false)

#define SPOOL_CHECK_OP(a, op, b)                                                                \
  do {                                                                                          \
    const auto& check_a_ = (a);                                                                 \
    const auto& check_b_ = (b);                                                                 \
    if (!(check_a_ op check_b_)) {                                                              \
      fmt::print(stderr, "{}:{}: check failed: {} {} {} ({} against {})\n", __FILE__, __LINE__, \
                 #a, #op, #b, check_a_, check_b_);                                              \
      std::abort();                                                                             \
    }                                                                                           \
  } while (false)

#define SPOOL_CHECK_EQ(a, b) SPOOL_CHECK_OP(a, ==, b)
#define SPOOL_CHECK_LE(a, b) SPOOL_CHECK_OP(a, <=, b)
#define SPOOL_CHECK_LT(a, b) SPOOL_CHECK_OP(a, <, b)
#define SPOOL_CHECK_GE(a, b) SPOOL_CHECK_OP(a, >=, b)
#define SPOOL_CHECK_GT(a, b) SPOOL_CHECK_OP(a, >, b)
