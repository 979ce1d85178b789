#include "tools/batch/kept_images.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <set>
#include <utility>

#include "lib/core/worker_threads.h"
#include "lib/image_io/exr_image.h"
#include "tools/terminal/progress.h"
#include "tools/verbs/result_pictures.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTitle = "spool.title";
constexpr const char* kBudget = "spool.budget";
constexpr const char* kRecording = "spool.recording";

// Brighter than eight times the budget is rare, and a scale that depends on the budget only can be
// compared between methods.
constexpr double kDensityRange = 8.0;

constexpr ExrWriteOptions kReplace = {.overwrite = true, .shared = true};

struct KeptResult {
  RgbImage estimate;
  std::optional<RgbImage> reference;
  ResultImages images;
  double spp = 0.0;
};

Result<RgbImage> rgb_of(const fs::path& path, const ExrFile& file) {
  RgbImage image;
  const char* names[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const Plane* plane = file.find(names[c]);
    if (!plane) return fail(ErrorCode::kData, "{}: has no channel {}", path.string(), names[c]);
    image[c] = *plane;
  }
  return image;
}

// The only channel of a file; absent where there is no file.
Result<std::optional<Plane>> read_plane(const fs::path& path) {
  std::error_code status;
  if (!fs::exists(path, status)) return std::nullopt;
  SPOOL_ASSIGN(ExrFile file, read_exr(path));
  if (file.channels.size() != 1)
    return fail(ErrorCode::kData, "{}: has not one channel: evaluate again", path.string());
  return std::move(file.channels.front().data);
}

Result<void> check_size(const fs::path& path, const Plane& plane, const Plane& like) {
  if (plane.same_size(like)) return {};
  return fail(ErrorCode::kData, "{}: is {} x {} pixels, the estimate {} x {}: evaluate again",
              path.string(), plane.width(), plane.height(), like.width(), like.height());
}

// Where images are judged by samples that they were not made of, each has its own reference.
fs::path reference_path(const fs::path& folder, const ExrFile& estimate) {
  std::error_code status;
  if (fs::exists(folder / "reference.exr", status)) return folder / "reference.exr";
  const auto name = estimate.text_attributes.find(kRecording);
  if (name == estimate.text_attributes.end() || name->second.find('/') != std::string::npos)
    return {};
  return folder.parent_path() / (name->second + "_reference.exr");
}

// Into `kept`, which stays where it is: its images point to its own planes.
Result<void> read_result(const fs::path& folder, KeptResult& kept) {
  const fs::path path = folder / "estimate.exr";
  SPOOL_ASSIGN(const ExrFile file, read_exr(path));
  SPOOL_ASSIGN(kept.estimate, rgb_of(path, file));
  ResultImages& images = kept.images;
  images.estimate = &kept.estimate;
  if (const auto title = file.text_attributes.find(kTitle); title != file.text_attributes.end())
    images.title = title->second;
  if (const auto spp = file.number_attributes.find(kBudget); spp != file.number_attributes.end())
    kept.spp = spp->second;
  std::error_code status;
  if (const fs::path other = reference_path(folder, file); fs::exists(other, status)) {
    SPOOL_ASSIGN(const ExrFile reference, read_exr(other));
    SPOOL_ASSIGN(kept.reference, rgb_of(other, reference));
    SPOOL_TRY(check_size(other, (*kept.reference)[0], kept.estimate[0]));
    images.reference = &*kept.reference;
  }
  SPOOL_ASSIGN(std::optional<Plane> density, read_plane(folder / "density.exr"));
  images.density = density ? std::move(*density) : Plane(1, 1);
  SPOOL_ASSIGN(images.level, read_plane(folder / "filter_size.exr"));
  SPOOL_ASSIGN(images.direction, read_plane(folder / "direction.exr"));
  SPOOL_ASSIGN(images.squared_error, read_plane(folder / "squared_error.exr"));
  SPOOL_ASSIGN(images.flip, read_plane(folder / "flip.exr"));
  return {};
}

// Completes the maps of a result, and draws it.
Result<void> make_pictures(const fs::path& folder, bool draw) {
  KeptResult kept;
  SPOOL_TRY(read_result(folder, kept));
  ResultImages& images = kept.images;
  const PictureScale scale =
      picture_scale(images.reference, kept.estimate, kDensityRange * kept.spp);
  const bool had_flip = images.flip.has_value();
  complete_maps(images, scale.exposure);
  if (images.flip && !had_flip)
    SPOOL_TRY(write_exr(folder / "flip.exr", exr_from_plane("flip", *images.flip), kReplace));
  // An older program, which wrote no title, drew at once.
  if (!draw || images.title.empty()) return {};
  SPOOL_TRY(write_contact_sheet(folder.string() + ".png", images, scale, true, true));
  return write_result_pictures(folder, images, scale, true, true);
}

std::vector<fs::path> result_folders(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(folder, status)) {
    std::error_code none;
    if (fs::is_regular_file(entry.path() / "estimate.exr", none)) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

// The first failure, in the order of the folders.
Result<void> make_all(const std::vector<fs::path>& folders, bool draw, Progress& progress) {
  std::vector<Result<void>> made(folders.size());
  std::atomic<std::size_t> done = 0;
  for_each_on_threads(folders.size(), allowed_threads(), [&](std::size_t i) {
    made[i] = make_pictures(folders[i], draw);
    progress.update(static_cast<double>(++done) / static_cast<double>(folders.size()));
  });
  for (const Result<void>& one : made)
    SPOOL_TRY(one);
  return {};
}

}  // namespace

ExrAttributes image_attributes(const std::string& title, double spp, const std::string& recording) {
  return {{{kTitle, title}, {kRecording, recording}}, {{kBudget, spp}}};
}

void remove_images(const fs::path& folder, const std::string& stem) {
  std::error_code status;
  fs::remove(folder / (stem + ".png"), status);
  // The estimate last: by it a result is known to have images.
  for (const std::string name :
       {"reference", "density", "filter_size", "direction", "squared_error", "flip", "estimate"}) {
    for (const char* kind : {".png", ".exr"})
      fs::remove(folder / stem / (name + kind), status);
  }
}

Result<std::size_t> draw_pictures(const fs::path& folder, const CommonOptions& common) {
  const std::vector<fs::path> folders = result_folders(folder);
  if (folders.empty()) {
    return fail(ErrorCode::kData,
                "{}: no images of results in it: spool evaluate keeps them unless --no-pictures",
                folder.string());
  }
  Progress progress("picture", common.quiet);
  SPOOL_TRY(make_all(folders, true, progress));
  return folders.size();
}

Result<void> make_flip_maps(const fs::path& folder, const std::vector<std::string>& names) {
  const std::vector<fs::path> results = result_folders(folder);
  std::set<fs::path> folders;  // one may be named twice
  for (const std::string& name : names) {
    const auto found = std::ranges::find(results, fs::path(name), &fs::path::filename);
    if (found == results.end()) {
      return fail(ErrorCode::kData, "{}: there are no images of a result '{}' in it",
                  folder.string(), name);
    }
    std::error_code status;
    if (!fs::exists(*found / "flip.exr", status)) folders.insert(*found);
  }
  Progress progress("FLIP maps", true);
  return make_all({folders.begin(), folders.end()}, false, progress);
}

}  // namespace spool::tools
