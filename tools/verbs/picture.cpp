#include "tools/verbs/picture.h"

#include <array>
#include <cmath>
#include <limits>

#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/image_io/png_writer.h"
#include "tools/batch/kept_images.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/picture_name.h"

namespace spool::tools {
namespace {

Result<ValueRange> parse_range(const std::string& text, bool log) {
  constexpr double kMost = std::numeric_limits<double>::max();
  if (const std::vector<std::string> parts = split_list(text); parts.size() == 2) {
    const auto low = parse_number("--range", parts[0], -kMost, kMost);
    const auto high = parse_number("--range", parts[1], -kMost, kMost);
    if (low && high && *low < *high && (!log || *low > 0.0)) return ValueRange{*low, *high, log};
  }
  return fail(ErrorCode::kUsage, "--range {}: write LOW,HIGH with LOW below HIGH{}", text,
              log ? ", both above 0 for --log" : "");
}

struct NamedMap {
  std::string name;
  Plane plane;
};

// One channel of the file as it is, or the luminance of its picture.
Result<NamedMap> map_of(const PictureOptions& options, std::string& remark) {
  const LayerChoice choice = options.channel.empty()
                                 ? options.layer
                                 : LayerChoice{options.channel, options.layer.part, "--channel "};
  SPOOL_ASSIGN(ForeignPicture picture, read_single_or_picture(options.image, choice));
  if (!options.channel.empty()) picture.remarks.clear();  // who names a channel knows of others
  remark = remark_line(options.image.string(), picture);
  const RgbImage& rgb = picture.rgb;
  Plane result(rgb[0].width(), rgb[0].height());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = picture.channel.empty() ? luminance(rgb[0][i], rgb[1][i], rgb[2][i]) : rgb[0][i];
  return NamedMap{picture.channel.empty() ? "luminance" : picture.channel, std::move(result)};
}

Result<Picture> false_colour_picture(const PictureOptions& options, std::string& remark) {
  SPOOL_ASSIGN(const NamedMap map, map_of(options, remark));
  const std::array<const Plane*, 1> planes = {&map.plane};
  ValueRange range = common_range(planes, options.log);
  if (!options.range.empty()) {
    SPOOL_ASSIGN(range, parse_range(options.range, options.log));
  }
  return labelled_picture({options.image.filename().string(), false_colour(map.plane, range),
                           ColourBar{range, map.name}});
}

Result<Picture> tone_mapped_picture(const PictureOptions& options, std::string& remark) {
  SPOOL_ASSIGN(const ForeignPicture picture, read_picture(options.image, options.layer));
  std::optional<ForeignPicture> guide;
  if (!options.like.empty()) {
    SPOOL_ASSIGN(guide, read_picture(options.like, kNoLayerOption));
  }
  remark = remark_line(options.image.string(), picture);
  return tone_map(picture.rgb, options.exposure ? std::exp2(*options.exposure)
                                                : tone_exposure(guide ? guide->rgb : picture.rgb));
}

}  // namespace

Result<void> validate(const PictureOptions& options) {
  std::error_code status;
  if (std::filesystem::is_directory(options.image, status)) {
    if (options.exposure || !options.like.empty() || options.false_colour ||
        !options.layer.layer.empty() || !options.layer.part.empty()) {
      return fail(ErrorCode::kUsage,
                  "{}: is a folder, whose pictures have one exposure and one scale: options of a "
                  "single image are left out",
                  options.image.string());
    }
    if (options.output.empty()) return {};
    return fail(ErrorCode::kUsage, "-o {}: pictures of results lie beside them: leave it out",
                options.output.string());
  }
  if (!options.flip_maps.empty()) {
    return fail(ErrorCode::kUsage,
                "--flip-map {}: {} is no folder of results: spool show draws the map of two images",
                options.flip_maps.front(), options.image.string());
  }
  if (options.output.empty()) {
    return fail(ErrorCode::kUsage, "{}: is no folder of results: name the picture, -o PICTURE.png",
                options.image.string());
  }
  if (!is_png_name(options.output)) {
    return fail(ErrorCode::kUsage, "-o {}: a PNG is what is written: name it .png",
                options.output.string());
  }
  if (!options.range.empty()) SPOOL_TRY(parse_range(options.range, options.log));
  return options.exposure ? check_bounds("exposure", *options.exposure, kExposure) : Result<void>{};
}

Result<void> run_picture(const PictureOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  if (!options.flip_maps.empty()) return make_flip_maps(options.image, options.flip_maps);
  if (options.output.empty()) {
    SPOOL_ASSIGN(const std::size_t drawn, draw_pictures(options.image, common));
    if (!common.quiet) print_line(options.image.string() + ": " + counted(drawn, "result"));
    return {};
  }
  for (const auto& input : {options.image, options.like})
    SPOOL_TRY(format::refuse_own_input(options.output, input));
  SPOOL_TRY(refuse_existing(options.output, common.force));
  std::string remark;
  SPOOL_ASSIGN(const Picture picture, options.false_colour ? false_colour_picture(options, remark)
                                                           : tone_mapped_picture(options, remark));
  SPOOL_TRY(write_png(options.output, picture, common.force));
  print_note(remark);
  if (!common.quiet) {
    print_line(fmt::format("{}: {} x {}", options.output.string(), picture.width, picture.height));
  }
  return {};
}

}  // namespace spool::tools
