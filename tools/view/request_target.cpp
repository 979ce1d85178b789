#include "tools/view/request_target.h"

#include <cstddef>

#include "lib/core/percent_text.h"

namespace spool::tools {
namespace {

// What precedes the first `end`; the text then begins behind it.
std::string_view cut(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  return head;
}

}  // namespace

RequestTarget parse_target(std::string_view target) {
  if (!target.starts_with('/')) return {};
  target.remove_prefix(1);
  std::string_view path = cut(target, '?');
  const std::string_view token = cut(path, '/');
  return {std::string(token), std::string(path), std::string(target)};
}

std::string parameter_of(std::string_view parameters, std::string_view name) {
  while (!parameters.empty()) {
    std::string_view value = cut(parameters, '&');
    if (cut(value, '=') == name) return percent_decoded(value);
  }
  return "";
}

}  // namespace spool::tools
