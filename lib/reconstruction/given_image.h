// An image somebody else made, as a reconstructor: for filters outside this program.
#pragma once

#include <string>

#include "lib/reconstruction/reconstructor.h"

namespace spool {

// Hands `image` back for any selection of its size; `name` stands in the error of any other size.
ReconstructorFunction given_image(RgbImage image, std::string name);

}  // namespace spool
