// Where the wedges of the directional filter bank lie, by its number of stages l = 0 .. 3.
#pragma once

#include <vector>

namespace spool {

// Borders between the wedges in degrees, ascending in [0, 180): wedge i of 2^l lies between border
// i and i + 1 (of l = 1: 135 .. 45 and 45 .. 135).
std::vector<double> band_borders(int levels);

// Mid angles of the wedges in frequency, degrees in [0, 180); and the spatial direction along which
// such an image is constant, frequency angle + 90 modulo 180. Indexed by band.
std::vector<double> band_frequency_angles(int levels);
std::vector<double> band_tangents(int levels);

}  // namespace spool
