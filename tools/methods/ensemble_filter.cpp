#include "tools/methods/ensemble_filter.h"

#include <functional>
#include <utility>

namespace spool::tools {

std::vector<std::string> ensemble_parts(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (c == '+' && depth <= 0) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

Result<ReadyFilter> make_ensemble_filter(const MethodList<FilterFunction>& known,
                                         const std::string& parts, const OptionValues& set) {
  SPOOL_ASSIGN(const EnsembleOptions options,
               with_options(ensemble_option_table(), EnsembleOptions{}, set));
  const std::vector<std::string> names = ensemble_parts(parts);
  if (names.size() < 2 || names.size() > kMostEnsembleParts) {
    return fail(ErrorCode::kUsage,
                "ensemble:{}: {} parts: name 2 to {}, as in ensemble:oidn+twin_guides", parts,
                names.size(), kMostEnsembleParts);
  }
  std::vector<ReadyFilter> ready;
  std::vector<std::function<Result<void>()>> checks;
  for (const std::string& name : names) {
    SPOOL_ASSIGN(const MethodChoice choice, choose_method(known, name));
    if (choice.name == "ensemble" || !choice.own_label.empty()) {
      return fail(ErrorCode::kUsage, "ensemble:{}: {} is no part: name filters, without labels",
                  parts, name);
    }
    SPOOL_ASSIGN(ReadyFilter part, describe_method(known, choice));
    if (part.installed) checks.push_back(part.installed);
    ready.push_back(std::move(part));
  }
  ReadyFilter made = ensemble(std::move(ready), options);
  made.installed = [checks]() -> Result<void> {
    for (const auto& installed : checks)
      SPOOL_TRY(installed());
    return {};
  };
  return made;
}

}  // namespace spool::tools
