// The images that an evaluation kept, drawn on demand: a contact sheet and single pictures
// of every result, from its EXR files and those attributes of the estimate that say what it is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"
#include "tools/terminal/console.h"

namespace spool::tools {

// Of an estimate: what stands above its pictures, the budget in samples per pixel, and the
// recording, by the name that its reference NAME_reference.exr has beside the folders of results.
ExrAttributes image_attributes(const std::string& title, double spp, const std::string& recording);

// Removes the images and pictures of the result `stem`. Other files in its folder are the user's,
// and the folder stays: another process may be about to write into it.
void remove_images(const std::filesystem::path& folder, const std::string& stem);

// Draws every result in `folder`, and maps that are not kept; returns how many. kData where there
// is none, or where the images of one do not belong together.
Result<std::size_t> draw_pictures(const std::filesystem::path& folder, const CommonOptions& common);

// Makes the FLIP maps of these results in `folder`, by the names of their folders, that are not
// kept. kData where one of them is no result.
Result<void> make_flip_maps(const std::filesystem::path& folder,
                            const std::vector<std::string>& names);

}  // namespace spool::tools
