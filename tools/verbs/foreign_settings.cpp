#include "tools/verbs/foreign_settings.h"

namespace spool::tools {

Result<OptionValues> foreign_settings(std::string_view part,
                                      const std::vector<std::string>& settings,
                                      std::string_view example) {
  const std::string start = fmt::format("{}.", part);
  OptionValues values;
  for (const std::string& text : settings) {
    const std::size_t equals = text.find('=');
    if (!text.starts_with(start) || equals == std::string::npos || equals <= start.size()) {
      return fail(ErrorCode::kUsage, "--set {}: write {}OPTION=VALUE, for example {}{}", text,
                  start, start, example);
    }
    values.emplace_back(text.substr(start.size(), equals - start.size()), text.substr(equals + 1));
  }
  return values;
}

}  // namespace spool::tools
