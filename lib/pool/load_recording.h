// Opens a .spool file as a recording: radiance in place where it is stored raw, decoded in parallel
// where not, with film positions, reference and cost where they were recorded.
//
// The file stays mapped while the recording lives; truncating it meanwhile raises SIGBUS (POSIX).
#pragma once

#include <filesystem>
#include <memory>

#include "lib/core/error.h"
#include "lib/pool/recorded_samples.h"

namespace spool {

// Errors: those of format::SpoolReader; kDamage when a block of the radiance is missing, naming its
// tile and samples; those of RecordedSamples::create. The seconds a sample took come from the
// top-level meta key `cost_per_sample`.
Result<std::shared_ptr<const RecordedSamples>> load_recording(const std::filesystem::path& path,
                                                              const SanitiseRules& rules = {});

}  // namespace spool
