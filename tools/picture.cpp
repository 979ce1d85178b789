#include "tools/picture.h"

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/png_writer.h"
#include "tools/picture_name.h"

namespace spool::tools {
namespace {

Result<ValueRange> parse_range(const std::string& text, bool log) {
  ValueRange range{0.0, 0.0, log};
  const std::vector<std::string> parts = split_list(text);
  bool good = parts.size() == 2;
  const std::array<double*, 2> ends = {&range.low, &range.high};
  for (std::size_t i = 0; good && i < 2; ++i) {
    const char* end = parts[i].data() + parts[i].size();
    const auto parsed = std::from_chars(parts[i].data(), end, *ends[i]);
    good = parsed.ec == std::errc() && parsed.ptr == end && std::isfinite(*ends[i]);
  }
  if (!good || range.low >= range.high || (log && range.low <= 0.0)) {
    return fail(ErrorCode::kUsage, "--range {}: write LOW,HIGH with LOW below HIGH{}", text,
                log ? ", both above 0 for --log" : "");
  }
  return range;
}

Result<Plane> plane_of(const ExrFile& file, const std::string& channel, const std::string& name) {
  if (!channel.empty()) {
    if (const Plane* found = file.find(channel)) return *found;
    std::string known;
    for (const NamedPlane& plane : file.channels)
      known += (known.empty() ? "" : ", ") + plane.name;
    return fail(ErrorCode::kUsage, "{}: no channel {}: there are {}", name, channel, known);
  }
  if (file.channels.size() == 1) return file.channels.front().data;
  SPOOL_ASSIGN(const RgbImage image, rgb_from_exr(file, name));
  Plane result(file.width, file.height);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = luminance(image[0][i], image[1][i], image[2][i]);
  return result;
}

Result<Picture> false_colour_picture(const ExrFile& file, const PictureOptions& options) {
  SPOOL_ASSIGN(const Plane plane, plane_of(file, options.channel, options.image.string()));
  const std::array<const Plane*, 1> planes = {&plane};
  ValueRange range = common_range(planes, options.log);
  if (!options.range.empty()) {
    SPOOL_ASSIGN(range, parse_range(options.range, options.log));
  }
  const std::string named = options.channel.empty() && file.channels.size() == 1
                                ? file.channels.front().name
                                : options.channel;
  return labelled_picture({options.image.filename().string(), false_colour(plane, range),
                           ColourBar{range, named.empty() ? "luminance" : named}});
}

Result<Picture> tone_mapped_picture(const ExrFile& file, const PictureOptions& options) {
  SPOOL_ASSIGN(const RgbImage image, rgb_from_exr(file, options.image.string()));
  if (options.exposure) return tone_map(image, std::exp2(*options.exposure));
  if (options.like.empty()) return tone_map(image, tone_exposure(image));
  SPOOL_ASSIGN(const ExrFile other, read_exr(options.like));
  SPOOL_ASSIGN(const RgbImage guide, rgb_from_exr(other, options.like.string()));
  return tone_map(image, tone_exposure(guide));
}

}  // namespace

Result<void> run_picture(const PictureOptions& options, const CommonOptions& common) {
  if (!is_png_name(options.output)) {
    return fail(ErrorCode::kUsage, "{}: a PNG is what is written: name it .png",
                options.output.string());
  }
  SPOOL_ASSIGN(const ExrFile file, read_exr(options.image));
  SPOOL_ASSIGN(const Picture picture, options.false_colour ? false_colour_picture(file, options)
                                                           : tone_mapped_picture(file, options));
  SPOOL_TRY(write_png(options.output, picture, common.force));
  if (!common.quiet) {
    print_line(fmt::format("{}: {} x {}", options.output.string(), picture.width, picture.height));
  }
  return {};
}

}  // namespace spool::tools
