#include "tools/batch/dump_meta.h"

#include <algorithm>
#include <cctype>

#include "formats/bounded_json.h"

namespace spool::tools {
namespace {

constexpr std::size_t kLongestName = 64;

}  // namespace

nlohmann::ordered_json merged_meta(const format::SpoolReader& reader) {
  nlohmann::ordered_json merged = nlohmann::ordered_json::object();
  for (const std::string& text : reader.meta()) {
    const auto part = format::parse_json<nlohmann::ordered_json>(text);
    if (!part.is_object()) continue;  // the reader has checked it; this is for the type's sake
    for (const auto& [key, value] : part.items())
      merged[key] = value;
  }
  return merged;
}

std::string recording_group(const nlohmann::ordered_json& meta) {
  const auto group = meta.find("group");
  if (group == meta.end() || !group->is_object()) return {};
  std::string text;
  for (const char* key : {"name", "id"}) {
    const auto part = group->find(key);
    if (part == group->end() || !part->is_string()) return {};
    const std::string word = part->get<std::string>();
    const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
      return std::isalnum(c) || c == '_' || c == '-' || c == '.';
    });
    if (!plain || word.empty() || word.size() > kLongestName)
      return {};  // it names columns and files
    text += (text.empty() ? "" : "-") + word;
  }
  return text;
}

std::string recording_group(const format::SpoolReader& reader) {
  return recording_group(merged_meta(reader));
}

std::optional<double> cost_per_sample(const nlohmann::ordered_json& meta) {
  const auto found = meta.find("cost_per_sample");
  if (found == meta.end() || !found->is_number()) return std::nullopt;
  const double seconds = found->get<double>();
  return seconds > 0.0 ? std::optional(seconds) : std::nullopt;
}

}  // namespace spool::tools
