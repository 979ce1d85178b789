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

#include <filesystem>
#include <optional>

#include "formats/interchange/import_format.h"
#include "lib/core/error.h"

namespace spool::interchange {

enum class NpzLayout { kHWSC, kSHWC };  // [y][x][s][c], [s][y][x][c]

struct NpzImportOptions : ImportOptions {
  std::optional<NpzLayout> layout;
  bool narrow = false;  // take f8 and round it to f4
};

Result<ImportReport> import_npz(const std::filesystem::path& in, const std::filesystem::path& out,
                                const NpzImportOptions& options = {});

ImportFormat npz_format();

}  // namespace spool::interchange
