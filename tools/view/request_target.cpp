#include "tools/view/request_target.h"

#include <charconv>
#include <cstddef>

namespace spool::tools {
namespace {

// What precedes the first `end`; the text then begins behind it.
std::string_view cut(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  return head;
}

std::string without_escapes(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      plain += static_cast<char>(byte);
      i += 2;
    } else {
      plain += text[i];
    }
  }
  return plain;
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
    if (cut(value, '=') == name) return without_escapes(value);
  }
  return "";
}

}  // namespace spool::tools
