// Remarks that a recorder left in a recording's meta data.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "formats/spool_reader.h"

namespace spool::tools {

// The `meta` records combined; later top-level keys replace earlier ones.
nlohmann::ordered_json merged_meta(const format::SpoolReader& reader);

// Seconds of rendering per sample of a pixel: the remark `cost_per_sample`, if there is one.
std::optional<double> cost_per_sample(const nlohmann::ordered_json& meta);

// "NAME-ID" where a recorder made the recording as one of several of a scene (remark `group`), else
// empty.
std::string recording_group(const nlohmann::ordered_json& meta);
std::string recording_group(const format::SpoolReader& reader);

}  // namespace spool::tools
