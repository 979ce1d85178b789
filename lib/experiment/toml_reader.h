// Values of a TOML text, and errors that name its line.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "lib/core/error.h"

namespace spool {

// Of budgets, and of methods that come out of a sweep: beyond, the cells would be too many to list.
inline constexpr std::size_t kMostValues = 2000;

// The values of a key that holds one value or a list.
std::vector<const toml::node*> values_of(const toml::node& node);

// TOML is UTF-8, names of files are bytes: a name that is none is written as file:NAME with its
// bytes as percent signs and digits, as RFC 8089 has them; so is one that itself starts with
// "file:".
std::string file_of_text(const std::string& text);

class TomlReader {
 public:
  explicit TomlReader(std::string name) : name_(std::move(name)) {}

  const std::string& name() const { return name_; }

  template <class... Args>
  tl::unexpected<Error> refuse(const toml::node& where, fmt::format_string<Args...> format,
                               Args&&... args) const {
    return fail(ErrorCode::kUsage, "{}:{}: {}", name_, where.source().begin.line,
                fmt::format(format, std::forward<Args>(args)...));
  }

  // The same result, or its error with the line of the text before it.
  template <class T>
  Result<T> at(const toml::node& where, Result<T> result) const {
    if (result) return result;
    return refuse(where, "{}", result.error().message);
  }

  // Of a number, a text, or "on" and "off" for true and false.
  Result<std::string> text_of(const toml::node& node) const;

 private:
  std::string name_;  // of the file, for messages
};

}  // namespace spool
