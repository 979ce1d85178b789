// `--set import.OPTION=VALUE` and `--set export.OPTION=VALUE`: options of foreign formats.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"

namespace spool::tools {

// `part`: "import" or "export". Error kUsage for settings of anything else, with the example.
Result<OptionValues> foreign_settings(std::string_view part,
                                      const std::vector<std::string>& settings,
                                      std::string_view example);

// "export.names=plain|blender" for "--names", or nothing: such options are none of the verb.
template <class Formats>
std::string setting_of_flag(std::string_view part, std::string flag, const Formats& formats) {
  for (char& c : flag)
    c = c == '-' ? '_' : c;
  for (const auto& format : formats) {
    for (const OptionDescription& option : format.describe()) {
      if (flag == "__" + option.name || flag.ends_with("_" + option.name))
        return fmt::format("{}.{}={}", part, option.name, option.allowed);
    }
  }
  return "";
}

}  // namespace spool::tools
