// All foreign formats that a dump can be made of.
#pragma once

#include <vector>

#include "formats/interchange/import_format.h"

namespace spool::exchange {

const std::vector<interchange::ImportFormat>& import_formats();

}  // namespace spool::exchange
