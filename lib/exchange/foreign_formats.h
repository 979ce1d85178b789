// All foreign formats: those that a recording can be made of, and those that can be made of a
// recording.
#pragma once

#include <vector>

#include "formats/interchange/export_format.h"
#include "formats/interchange/import_format.h"

namespace spool::exchange {

const std::vector<interchange::ImportFormat>& import_formats();
const std::vector<interchange::ExportFormat>& export_formats();

}  // namespace spool::exchange
