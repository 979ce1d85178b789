// numpy arrays and the library's images.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>

#include "lib/core/error.h"
#include "lib/core/image.h"

namespace spool::python {

namespace nb = nanobind;

using ImageArray = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using PlaneArray = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using CountArray = nb::ndarray<const std::int64_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using SampleArray = nb::ndarray<const float, nb::ndim<4>, nb::c_contig, nb::device::cpu>;

nb::object plane_to_numpy(const Plane& plane);         // [y][x] float64
nb::object counts_to_numpy(const CountImage& counts);  // [y][x] int32
nb::object rgb_to_numpy(const RgbImage& image);        // [y][x][c] float64

Plane plane_from_numpy(const PlaneArray& array);
// kUsage where there is no pixel, or more than an image may have.
Result<void> check_image_size(std::size_t width, std::size_t height, const std::string& name);
RgbImage rgb_from_numpy(const ImageArray& array);
// kData when a count is negative or beyond 32 bits; `name` says whose they are.
Result<CountImage> counts_from_numpy(const CountArray& array, const std::string& name);

}  // namespace spool::python
