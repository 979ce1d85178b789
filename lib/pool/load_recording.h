// Opens a .spool file as a recording: radiance in place where it is stored raw, decoded in parallel
// where not, with film positions, reference and cost where they were recorded.
//
// The file stays mapped while the recording lives. When it is cut meanwhile, POSIX raises SIGBUS; a
// process that called format::survive_lost_pages() reads zeros, and asks still_intact() whether it
// did.
#pragma once

#include <filesystem>
#include <memory>

#include "lib/core/error.h"
#include "lib/core/working_memory.h"
#include "lib/pool/recorded_samples.h"

namespace spool {

// Film positions that differ from pixel to pixel take 8 bytes a sample. Left out, the recording has
// none; those of whole passes are always there.
enum class SampleFilm { kLoad, kLeaveOut };

// Errors: those of format::SpoolReader; kDamage when a block of the radiance is missing, naming its
// tile and samples; those of RecordedSamples::create. The seconds a sample took come from the
// top-level meta key `cost_per_sample`. kData, before anything is loaded, when samples, reference
// and `work` together are more than available_memory(). `pass`, which may be null, gets the samples
// as they are read; they are not expected to be read again then.
Result<std::shared_ptr<const RecordedSamples>> load_recording(const std::filesystem::path& path,
                                                              const SanitiseRules& rules = {},
                                                              const WorkingMemory& work = {},
                                                              SampleFilm film = SampleFilm::kLoad,
                                                              FirstPass* pass = nullptr);

// Whether the file of a recording held all it should whenever it was read; asked before what was
// made of the samples is believed. kDamage when pages were lost; recordings that did not come from
// load_recording() are always whole.
Result<void> still_intact(const std::shared_ptr<const RecordedSamples>& recording);

}  // namespace spool
