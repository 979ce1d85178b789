#include "formats/other_kinds.h"

#include <cstring>

namespace spool::format {
namespace {

struct Kind {
  std::string_view start, name;
};

using namespace std::string_view_literals;

// Beginnings as the pages of the formats give them.
constexpr Kind kKinds[] = {
    {"\x76\x2f\x31\x01"sv, "an OpenEXR image"},
    {"PK\x03\x04"sv, "a zip archive"},
    {"PK\x05\x06"sv, "a zip archive"},
    {"\x89SPL"sv, "a .spool file"},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file"},
    {"\x93NUMPY"sv, "a single .npy array"},
    {"\x89PNG\r\n\x1a\n"sv, "a PNG picture"},
    {"\xff\xd8\xff"sv, "a JPEG picture"},
    {"II*\0"sv, "a TIFF picture"},
    {"MM\0*"sv, "a TIFF picture"},
    {"#?RADIANCE"sv, "a Radiance HDR picture"},
    {"#?RGBE"sv, "a Radiance HDR picture"},
    {"PF\n"sv, "a PFM picture"},
    {"Pf\n"sv, "a PFM picture"},
    {"GIF8"sv, "a GIF picture"},
    {"8BPS"sv, "a Photoshop picture"},
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
    {"\x28\xb5\x2f\xfd"sv, "compressed by zstd"},
    {"\x1f\x8b"sv, "compressed by gzip"},
    {"BZh"sv, "compressed by bzip2"},
    {"\xfd"
     "7zXZ\0"sv,
     "compressed by xz"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7z archive"},
    {"version https://git-lfs"sv, "a pointer of Git LFS (git lfs pull fetches the file)"},
    {"<!DOCTYPE"sv, "a web page"},
    {"<html"sv, "a web page"},
};

}  // namespace

std::string_view kind_of(std::span<const std::byte> start) {
  for (const Kind& kind : kKinds)
    if (start.size() >= kind.start.size() &&
        std::memcmp(start.data(), kind.start.data(), kind.start.size()) == 0)
      return kind.name;
  return {};
}

Result<void> refuse_other_kind(const std::string& name, std::span<const std::byte> start,
                               std::string_view wanted, std::string_view remedy) {
  if (start.empty())
    return fail(ErrorCode::kDamage, "{}: is empty: write it again, or fetch it", name);
  const std::string_view kind = kind_of(start);
  if (kind.empty() || kind == wanted) return {};
  return fail(ErrorCode::kData, "{}: is {}, {} is needed: {}", name, kind, wanted, remedy);
}

}  // namespace spool::format
