// The arrays of an .npz file, before anything is known about samples.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/file_handle.h"
#include "formats/interchange/npy_header.h"
#include "formats/interchange/zip_directory.h"
#include "lib/core/error.h"

namespace spool::interchange {

struct NpzMember {
  std::string layer;  // the member's name without ".npy"; a valid layer name
  ZipMember zip;
  NpyHeader header;  // its shape and type give exactly the bytes of the member
};

// In file order. Errors: kData for names and arrays that are not taken, kDamage for sizes that lie.
Result<std::vector<NpzMember>> read_npz_members(const format::FileHandle& file);

// The JSON object in the array `meta`: characters as u1, or a string without axes.
Result<nlohmann::json> read_npz_meta(const format::FileHandle& file, const NpzMember& member);

// "(64,64,16,3)"
std::string shape_text(const std::vector<uint64_t>& shape);

}  // namespace spool::interchange
