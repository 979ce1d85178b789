// Intermediate images as layers of an EXR, and as pictures for people.
//
// Beside the views of a method (`spool list views`) every result has some that follow from its
// selection and its image: n, A.k, level, dominant_direction, variance.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/view.h"
#include "lib/filters/filter.h"
#include "lib/image_io/exr_image.h"

namespace spool::tools {

// Views that every selection, every reconstruction has.
const std::vector<ViewDescription>& selection_views();
const std::vector<ViewDescription>& image_views();

// kUsage, with the nearest name, when one of `wanted` ("f", "f.2", "all") is of no family.
Result<void> check_views(const std::vector<std::string>& wanted,
                         const std::vector<ViewDescription>& known);

// Adds the wanted ones of selection_views() and image_views() that the method has not given.
void add_selection_views(const Selection& selection, Views& views);
void add_image_views(const Reconstruction& reconstruction, Views& views);

// Layers view.NAME of all views of the file's size; those of pieces into a file of pixels are left
// out, their names come back.
std::vector<std::string> add_view_layers(const Views& views, ExrFile& file);

// NAME.png of every view in `folder`: directions as hues, levels and stops as categories, the rest
// as false colours: logarithmic where the values are all positive and span more than 30, symmetric
// about 0 where some are negative.
Result<void> write_view_pictures(const Views& views, const std::filesystem::path& folder,
                                 bool overwrite);

}  // namespace spool::tools
