#include "tools/dump_meta.h"

#include "formats/bounded_json.h"

namespace spool::tools {

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

std::optional<double> cost_per_sample(const nlohmann::ordered_json& meta) {
  const auto found = meta.find("cost_per_sample");
  if (found == meta.end() || !found->is_number()) return std::nullopt;
  const double seconds = found->get<double>();
  return seconds > 0.0 ? std::optional(seconds) : std::nullopt;
}

}  // namespace spool::tools
