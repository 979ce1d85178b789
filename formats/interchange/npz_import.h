// numpy's .npz: a zip of arrays, one per layer; npz_export.h writes it.
//
// `radiance` [y][x][s][3] is mandatory; other sample layers are [y][x][s][c] or [y][x][s], layers
// of scope pixel [y][x][c], of scope pass [s][c]; `meta` is UTF-8 JSON in a u1 array and says
// layout, scope, channels and sample order. Without `meta.layout` it must be given: shapes are
// never guessed. Layers called `reference...` have scope pixel unless `meta.scope` says otherwise.
//
// Memory is bounded (dump_import.h): stored members are read in place, deflated ones are inflated
// into an unnamed file beside OUT first. Every checksum is verified before a sample is taken.
#pragma once

#include "formats/interchange/import_format.h"

namespace spool::interchange {

ImportFormat npz_format();

}  // namespace spool::interchange
