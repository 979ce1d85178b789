// What a file is by its first bytes, where it is not what a door expects: the one table of the
// doors. A file of another kind, or of a newer version, is neither cut nor damaged.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "lib/core/error.h"

namespace spool::format {

// "an HDF5 file"; empty for what the table does not have.
std::string_view kind_of(std::span<const std::byte> start);

// kDamage where there is nothing; kData where the file is of another known kind than `wanted`,
// which is spelt as in the table or is not in it: "FILE: is an HDF5 file, a zip archive is needed:
// REMEDY". `of_pictures`: the remedy for pictures, where it is another one.
Result<void> refuse_other_kind(const std::string& name, std::span<const std::byte> start,
                               std::string_view wanted, std::string_view remedy,
                               std::string_view of_pictures = {});

}  // namespace spool::format
