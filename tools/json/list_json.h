// What `spool list --json` prints.
#pragma once

#include <string>

#include "tools/verbs/listing.h"

namespace spool::tools {

std::string methods_text(const ListedMethods& methods);
std::string formats_text(const ListedMethods& formats);
std::string options_text(const std::vector<ListedOption>& options);
std::string presets_text(const std::vector<ListedPreset>& presets);
std::string table_text(const ListedTable& table);  // an object a row
std::string names_text(const ListedNames& names);

}  // namespace spool::tools
