#include "tools/show/show.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <system_error>
#include <utility>

#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/metrics/error_metrics.h"
#include "tools/verbs/page_generator.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

struct NamedFile {
  std::string name;
  fs::path path;
};

// "NAME=FILE", unless there is a file of the whole text; either may hold further signs.
NamedFile named_file(const std::string& text) {
  std::error_code status;
  const std::size_t first = text.find('=');
  if (first == std::string::npos || first == 0 || fs::exists(text, status)) {
    return {fs::path(text).stem().string(), text};
  }
  std::size_t split = first;
  while (split != std::string::npos && !fs::exists(text.substr(split + 1), status))
    split = text.find('=', split + 1);
  if (split == std::string::npos) split = first;
  return {text.substr(0, split), text.substr(split + 1)};
}

// Files of one name are labelled by their folder, else by a number.
std::vector<NamedFile> named_files(const std::vector<std::string>& texts) {
  std::vector<NamedFile> files;
  for (const std::string& text : texts)
    files.push_back(named_file(text));
  const auto alike = [&](const std::string& name) {
    return std::ranges::count(files, name, &NamedFile::name) > 1;
  };
  std::vector<std::string> names;
  for (const NamedFile& file : files) {
    const std::string folder = file.path.parent_path().filename().string();
    names.push_back(alike(file.name) && !folder.empty() ? folder + "/" + file.name : file.name);
  }
  std::set<std::string> taken;
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].name = names[i];
    for (int number = 2; !taken.insert(files[i].name).second; ++number)
      files[i].name = fmt::format("{}-{}", names[i], number);
  }
  return files;
}

// With its remark on stderr. kData when its pixels do not lie on those of the first picture.
Result<RgbImage> read_rgb(const fs::path& path, std::optional<ForeignPicture>& first,
                          const CommonOptions& common) {
  SPOOL_ASSIGN(ForeignPicture picture, read_picture(path, kNoLayerOption));
  if (!common.quiet) print_note(remark_line(path.string(), picture));
  RgbImage image = std::move(picture.rgb);
  picture.rgb = {};
  if (!first) first = picture;
  if (picture.shown.width == first->shown.width && picture.shown.height == first->shown.height)
    SPOOL_TRY(check_aligned(picture, *first, path.string(), "the first image"));
  return image;
}

bool is_page_name(const fs::path& path) {
  return path.extension() == ".html" || path.extension() == ".htm";
}

// "X,Y,WIDTH,HEIGHT" in whole numbers.
Result<ShownCrop> parse_crop(const std::string& text) {
  ShownCrop crop;
  const std::array<int*, 4> parts = {&crop.x, &crop.y, &crop.width, &crop.height};
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto parsed = std::from_chars(at, end, *parts[i]);
    const bool last = i + 1 == parts.size();
    if (parsed.ec != std::errc() ||
        (last ? parsed.ptr != end : parsed.ptr == end || *parsed.ptr != ',')) {
      return fail(ErrorCode::kUsage, "--crop {}: write X,Y,WIDTH,HEIGHT in pixels", text);
    }
    at = parsed.ptr + 1;
  }
  return crop;
}

}  // namespace

Result<void> validate(const ShowOptions& options) {
  if (!is_page_name(options.output)) {
    return fail(ErrorCode::kUsage, "{}: a page is what is written: name it .html",
                options.output.string());
  }
  return validate(options.settings);
}

Result<void> run_show(const ShowOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  for (const NamedFile& file : named_files(options.images))
    SPOOL_TRY(format::refuse_own_input(options.output, file.path));
  SPOOL_TRY(format::refuse_own_input(options.output, options.reference));
  SPOOL_TRY(refuse_existing(options.output, common.force));
  ShowSettings settings = options.settings;
  for (const std::string& text : options.crops) {
    SPOOL_ASSIGN(const ShownCrop crop, parse_crop(text));
    settings.crops.push_back(crop);
  }
  std::optional<ForeignPicture> first;
  std::vector<ShownImage> images;
  for (const NamedFile& file : named_files(options.images)) {
    ShownImage shown{file.name, {}};
    SPOOL_ASSIGN(shown.result.image, read_rgb(file.path, first, common));
    images.push_back(std::move(shown));
  }
  std::optional<RgbImage> reference;
  if (!options.reference.empty()) {
    SPOOL_ASSIGN(reference, read_rgb(options.reference, first, common));
  }
  SPOOL_ASSIGN(const std::string planes, shown_planes(images, reference, settings));
  for (const ShownImage& shown : images) {
    if (reference && is_the_reference(shown.result.image, *reference))
      print_note(shown.name + ": is the reference: its error has no meaning");
  }
  SPOOL_ASSIGN(const std::string html,
               run_generator("show_page", {}, planes, {"spool show", "numpy", "python3-numpy"}));
  SPOOL_TRY(write_text_file(options.output, html, common.force));
  if (!common.quiet) {
    print_line(fmt::format("{}: {}, {}", options.output.string(),
                           format_bytes(static_cast<double>(html.size())),
                           counted(images.size(), "image")));
  }
  return {};
}

}  // namespace spool::tools
