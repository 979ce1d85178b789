// From a .spool file to a recording that samplers can be replayed on.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "formats/spool_reader.h"
#include "lib/core/error.h"
#include "lib/pool/recorded_samples.h"

namespace spool::tools {

// The `meta` records combined; later top-level keys replace earlier ones.
nlohmann::ordered_json merged_meta(const format::SpoolReader& reader);

// Seconds of rendering per sample of a pixel: the remark `cost_per_sample`, if there is one.
std::optional<double> cost_per_sample(const nlohmann::ordered_json& meta);

// Raw f32 radiance stays in the file and is mapped; compressed or f16 radiance is decoded to
// memory. The file's own reference, its variance and film positions come along. Errors: those of
// SpoolReader and RecordedSamples; kDamage when blocks are missing.
Result<std::shared_ptr<const RecordedSamples>> load_recording(const std::filesystem::path& path,
                                                              const SanitiseRules& rules = {});

}  // namespace spool::tools
