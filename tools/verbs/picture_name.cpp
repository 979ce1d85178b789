#include "tools/verbs/picture_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

namespace spool::tools {
namespace {

std::string suffix_of(const std::filesystem::path& path) {
  std::string suffix = path.extension().string();
  std::ranges::transform(suffix, suffix.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

}  // namespace

bool is_png_name(const std::filesystem::path& path) {
  return suffix_of(path) == ".png";
}

Result<void> check_exr_name(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 13> kPictures = {".png", ".jpg",  ".jpeg", ".tif", ".tiff",
                                                          ".gif", ".bmp",  ".hdr",  ".pfm", ".webp",
                                                          ".jxl", ".avif", ".tga"};
  if (std::ranges::find(kPictures, suffix_of(path)) == kPictures.end()) return {};
  return fail(ErrorCode::kUsage,
              "{}: an OpenEXR image is what is written: name it .exr (a PNG is made by spool "
              "reconstruct -o NAME.png)",
              path.string());
}

}  // namespace spool::tools
