// A picture that another program wrote, as linear R, G, B of Rec. 709: the one reader of every
// door.
//
// Which layer it is: layer_choice.h; its colours: colour_space.h. The picture is what the display
// window shows of the data window (OpenEXR: "Technical Introduction"); types are half, float, or
// both. What was chosen, converted or left out stands in `remarks`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/image_io/layer_choice.h"

namespace spool {

struct ForeignPicture {
  RgbImage rgb;
  std::string channel;               // of a grey one
  std::string converted_from;        // the colours of the file, where they are not Rec. 709
  ExrWindow shown, display;          // what `rgb` holds, and all that is displayed
  std::vector<std::string> remarks;  // without the name of the file
};

// What a picture must be as large as.
struct NeededSize {
  std::int64_t width = 0, height = 0;
  std::string of = "the recording";
};

// kData, kUsage, kIo, kDamage as exr_source.h, layer_choice.h and colour_space.h say; kData also
// for whole numbers where light is meant, and for a data window outside of the display window.
// A wrong size is kData before a pixel is decoded: a small file may claim a huge picture.
Result<ForeignPicture> read_picture(const std::filesystem::path& path,
                                    const LayerChoice& choice = {},
                                    const std::optional<NeededSize>& needed = {});
// The same of a file that has one channel and may mean anything by it: a mask, a map.
Result<ForeignPicture> read_single_or_picture(const std::filesystem::path& path,
                                              const LayerChoice& choice = {},
                                              const std::optional<NeededSize>& needed = {});
// All of a picture but its pixels.
Result<ForeignPicture> read_picture_header(const std::filesystem::path& path,
                                           const LayerChoice& choice);
Result<void> check_size(const std::string& name, const ExrWindow& window, const NeededSize& needed);

// kData where the pixels of `name` do not lie on those of `other`, in the plane of OpenEXR or in
// their displays.
Result<void> check_aligned(const ForeignPicture& picture, const ForeignPicture& reference,
                           std::string_view name, std::string_view other);

// "x 0 to 9, y 0 to 5"
std::string text_of(const ExrWindow& window);

// "FILE: a; b", one line for the user; "" when there is nothing to say.
std::string remark_line(const std::string& file, const std::vector<std::string>& remarks);
// Of a picture to look at: also how many of its pixels are not finite.
std::string remark_line(const std::string& file, const ForeignPicture& picture);

// What of a file is not `used` (part and channel), by layers: "A, albedo, depth.Z and 4 more".
std::string unused_channels(const std::vector<ExrPart>& parts, const std::vector<ExrLayer>& layers,
                            const std::vector<std::pair<std::size_t, std::size_t>>& used);

}  // namespace spool
