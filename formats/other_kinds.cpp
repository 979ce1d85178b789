#include "formats/other_kinds.h"

#include <cstring>

namespace spool::format {
namespace {

// What must become of it on the way to another kind.
enum class Group { kArrays, kLinear, kEncoded, kPacked };

struct Kind {
  std::string_view start, name;
  Group group = Group::kArrays;
};

using namespace std::string_view_literals;

// Beginnings as the pages of the formats give them.
constexpr Kind kKinds[] = {
    {"\x76\x2f\x31\x01"sv, "an OpenEXR image", Group::kLinear},
    {"PK\x03\x04"sv, "a zip archive"},
    {"PK\x05\x06"sv, "a zip archive"},
    {"\x89SPL"sv, "a .spool file"},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file"},
    {"\x93NUMPY"sv, "a single .npy array"},
    {"\x89PNG\r\n\x1a\n"sv, "a PNG picture", Group::kEncoded},
    {"\xff\xd8\xff"sv, "a JPEG picture", Group::kEncoded},
    {"II*\0"sv, "a TIFF picture", Group::kLinear},
    {"MM\0*"sv, "a TIFF picture", Group::kLinear},
    {"#?RADIANCE"sv, "a Radiance HDR picture", Group::kLinear},
    {"#?RGBE"sv, "a Radiance HDR picture", Group::kLinear},
    {"PF\n"sv, "a PFM picture", Group::kLinear},
    {"Pf\n"sv, "a PFM picture", Group::kLinear},
    {"PF\r"sv, "a PFM picture", Group::kLinear},
    {"PF "sv, "a PFM picture", Group::kLinear},
    {"II+\0"sv, "a TIFF picture", Group::kLinear},
    {"MM\0+"sv, "a TIFF picture", Group::kLinear},
    {"SDPX"sv, "a DPX picture", Group::kEncoded},
    {"XPDS"sv, "a DPX picture", Group::kEncoded},
    {"P5\n"sv, "a PNM picture", Group::kEncoded},
    {"P6\n"sv, "a PNM picture", Group::kEncoded},
    {"RIFF"sv, "a WebP picture, or sound", Group::kEncoded},
    {"\0\0\0\x0cjP  "sv, "a JPEG 2000 picture", Group::kEncoded},
    {"\xff\x4f\xff\x51"sv, "a JPEG 2000 picture", Group::kEncoded},
    {"\0\0\0\x0cJXL "sv, "a JPEG XL picture", Group::kEncoded},
    {"DDS "sv, "a DDS texture", Group::kEncoded},
    {"GIF8"sv, "a GIF picture", Group::kEncoded},
    {"8BPS"sv, "a Photoshop picture", Group::kEncoded},
    {"BLENDER"sv, "a Blender scene"},
    {"MATLAB "sv, "a MATLAB file"},
    {"CDF\x01"sv, "a NetCDF file"},
    {"CDF\x02"sv, "a NetCDF file"},
    {"SIMPLE  ="sv, "a FITS file"},
    {"PAR1"sv, "a Parquet file"},
    {"ARROW1"sv, "an Arrow file"},
    {"%PDF-"sv, "a PDF"},
    {"\x80\x02"sv, "a Python pickle"},
    {"\x80\x03"sv, "a Python pickle"},
    {"\x80\x04"sv, "a Python pickle"},
    {"\x80\x05"sv, "a Python pickle"},
    {"\x28\xb5\x2f\xfd"sv, "compressed by zstd", Group::kPacked},
    {"\x1f\x8b"sv, "compressed by gzip", Group::kPacked},
    {"BZh"sv, "compressed by bzip2", Group::kPacked},
    {"\xfd"
     "7zXZ\0"sv,
     "compressed by xz", Group::kPacked},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7z archive", Group::kPacked},
    {"version https://git-lfs"sv, "a pointer of Git LFS (git lfs pull fetches the file)"},
    {"<!DOCTYPE"sv, "a web page"},
    {"<html"sv, "a web page"},
};

const Kind* find_kind(std::span<const std::byte> start) {
  for (const Kind& kind : kKinds)
    if (start.size() >= kind.start.size() &&
        std::memcmp(start.data(), kind.start.data(), kind.start.size()) == 0)
      return &kind;
  return nullptr;
}

}  // namespace

std::string_view kind_of(std::span<const std::byte> start) {
  const Kind* kind = find_kind(start);
  return kind == nullptr ? std::string_view() : kind->name;
}

Result<void> refuse_other_kind(const std::string& name, std::span<const std::byte> start,
                               std::string_view wanted, std::string_view remedy,
                               std::string_view of_pictures) {
  if (start.empty())
    return fail(ErrorCode::kDamage, "{}: is empty: write it again, or fetch it", name);
  const Kind* kind = find_kind(start);
  if (kind == nullptr || kind->name == wanted) return {};
  const std::string_view first = kind->group == Group::kEncoded  ? "linearise it and "
                                 : kind->group == Group::kPacked ? "unpack it and "
                                                                 : "";
  const bool picture = kind->group == Group::kLinear || kind->group == Group::kEncoded;
  return fail(ErrorCode::kData, "{}: is {}, {} is needed: {}{}", name, kind->name, wanted, first,
              picture && !of_pictures.empty() ? of_pictures : remedy);
}

}  // namespace spool::format
