// What a notebook shows: pictures of images and densities, their numbers, and the page of images.
#pragma once

#include <nanobind/nanobind.h>

namespace spool::python {

void bind_showing(nanobind::module_& module);

}  // namespace spool::python
