// The one way from a text to JSON: its length and its depth are known before a parser reads it.
//
// The parser of nlohmann/json needs no stack, but copying, comparing and writing a value recurse,
// and a value takes up to fifty times the memory of its text. Whatever a file says therefore comes
// in here; tools/lint.py holds that no other code of formats/, lib/ and tools/ parses JSON.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace spool::format {

inline constexpr std::size_t kMaxJsonDepth = 64;
inline constexpr std::size_t kMaxJsonBytes = std::size_t{16} << 20;

// Whether arrays and objects stand at most `depth` deep in one another. Exact for JSON; a text that
// is none is left to the parser, but for a byte 0: the parser would take it for the end of the
// text.
bool nests_within(std::string_view text, std::size_t depth);

// The whole file; nothing when it cannot be read, is no regular file or has more than `max_bytes`.
std::optional<std::string> read_short_text(const std::filesystem::path& path,
                                           std::size_t max_bytes = kMaxJsonBytes);

// One JSON value; is_discarded() when the text is none, is longer than `max_bytes` or nests deeper
// than kMaxJsonDepth.
template <class Json = nlohmann::json>
Json parse_json(std::string_view text, std::size_t max_bytes = kMaxJsonBytes) {
  if (text.size() > max_bytes || !nests_within(text, kMaxJsonDepth))
    return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

// The parts of one JSON value one after the other, to a handler of nlohmann::json::sax_parse; false
// when the text is none, is too long, or the handler ends it. No value is made.
template <class Handler>
bool read_json(std::string_view text, Handler& handler) {
  if (text.size() > kMaxJsonBytes || text.find('\0') != std::string_view::npos) return false;
  return nlohmann::json::sax_parse(text.begin(), text.end(), &handler);
}

// The same of a file; discarded when it cannot be read too.
template <class Json = nlohmann::json>
Json parse_json_file(const std::filesystem::path& path, std::size_t max_bytes = kMaxJsonBytes) {
  const auto text = read_short_text(path, max_bytes);
  return text ? parse_json<Json>(*text, max_bytes) : Json(Json::value_t::discarded);
}

}  // namespace spool::format
