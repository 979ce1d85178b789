// What a .spool file did wrong, before the name of the file is known.
#pragma once

#include <filesystem>
#include <string>

#include <fmt/core.h>
#include <tl/expected.hpp>

#include "lib/core/error.h"

namespace spool::format {

// The classes of formats/spool.md 7, without `io`.
enum class FailureClass { kNotSpool, kUnsupported, kInvalid, kIncomplete, kDamaged };

struct Violation {
  FailureClass failure = FailureClass::kDamaged;
  std::string what;  // "what (where)"
};

template <class T>
using Judged = tl::expected<T, Violation>;

template <class... Args>
tl::unexpected<Violation> violates(FailureClass failure, fmt::format_string<Args...> format,
                                   Args&&... args) {
  return tl::unexpected<Violation>(
      Violation{failure, fmt::format(format, std::forward<Args>(args)...)});
}

// The one line for the user: file, what, where, and the remedy that belongs to the class.
Error file_error(const std::filesystem::path& file, const Violation& violation);

}  // namespace spool::format

// As SPOOL_TRY and SPOOL_ASSIGN (lib/core/error.h), for Judged.
#define SPOOL_JUDGE(expression)                                                            \
  do {                                                                                     \
    if (auto judge_result_ = (expression); !judge_result_.has_value())                     \
      return tl::unexpected<::spool::format::Violation>(std::move(judge_result_).error()); \
  } while (false)
