#include "tools/evaluation_pictures.h"

#include <algorithm>
#include <cctype>

#include "lib/image_io/exr_image.h"
#include "lib/image_io/png_writer.h"
#include "tools/result_pictures.h"

namespace spool::tools {
namespace {

// Brighter than eight times the budget is rare, and a scale that depends on the budget only can be
// compared between methods.
constexpr double kDensityRange = 8.0;

// Labels hold ':' and '{', which file names should not.
std::string file_name_of(const std::string& label) {
  std::string name = label;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
  }
  while (name.ends_with('_'))
    name.pop_back();
  return name;
}

std::string unique_name(const std::string& dump, std::map<std::string, std::string>& names) {
  const auto known = names.find(dump);
  if (known != names.end()) return known->second;
  const std::string stem = file_name_of(std::filesystem::path(dump).stem().string());
  std::string name = stem;
  const auto taken = [&] {
    return std::ranges::any_of(names, [&](const auto& entry) { return entry.second == name; });
  };
  for (int i = 2; taken(); ++i)
    name = fmt::format("{}-{}", stem, i);
  names[dump] = name;
  return name;
}

}  // namespace

Result<void> EvaluationPictures::add(const CellResult& result, const CellImages& images) {
  if (result.cell.replicate != 0) return {};
  const Cell& cell = result.cell;
  const std::string dump = unique_name(cell.dump, dump_names_);
  const std::string spp = fmt::format("{:g}spp", cell.spp);
  const PictureScale scale =
      picture_scale(&images.reference, images.image, kDensityRange * cell.spp);
  const double mse = result.metrics["mse"].value;
  const ResultImages pictures{fmt::format("{}  {} + {}  {:g} spp  MSE {:.3g}", dump,
                                          cell.sampler.label(), cell.filter.label(), cell.spp, mse),
                              &images.reconstruction, &images.selection.statistics.n,
                              &images.reference};
  const std::string stem = fmt::format("{}_{}_{}_{}", dump, file_name_of(cell.sampler.label()),
                                       file_name_of(cell.filter.label()), spp);
  std::error_code status;
  std::filesystem::create_directories(folder_ / stem, status);
  SPOOL_TRY(write_reference(result, images, dump, stem));
  SPOOL_TRY(write_result_pictures(folder_ / stem, pictures, scale, true));
  SPOOL_TRY(write_contact_sheet(folder_ / (stem + ".png"), pictures, scale, true));

  const std::string overview = dump + "_" + spp;
  auto found = std::ranges::find(overviews_, overview, &std::pair<std::string, Overview>::first);
  if (found == overviews_.end()) {
    found = overviews_.insert(
        found, {overview, {fmt::format("{}  {:g} samples per pixel", dump, cell.spp), {}}});
    found->second.panels.push_back(
        {"reference", tone_map(images.reference.mean, scale.exposure), {}});
  }
  found->second.panels.push_back({fmt::format("{} + {}", cell.sampler.label(), cell.filter.label()),
                                  tone_map(images.image, scale.exposure),
                                  Caption{fmt::format("MSE {:.3g}", mse)}});
  return {};
}

// Every result has its own reference where that is made of the samples it did not take.
Result<void> EvaluationPictures::write_reference(const CellResult& result, const CellImages& images,
                                                 const std::string& dump, const std::string& stem) {
  const bool own = result.reference == ReferenceKind::kLeaveSelectedOut;
  if (!own && !referenced_.insert(dump).second) return {};
  return write_exr(own ? folder_ / stem / "reference.exr" : folder_ / (dump + "_reference.exr"),
                   exr_from_rgb(images.reference.mean), {.overwrite = true});
}

Result<void> EvaluationPictures::finish() const {
  for (const auto& [stem, overview] : overviews_) {
    SPOOL_TRY(write_png(folder_ / (stem + ".png"), contact_sheet(overview.heading, overview.panels),
                        true));
  }
  return {};
}

std::string EvaluationPictures::describe() const {
  if (overviews_.empty()) return "none";
  std::string text;
  for (const auto& [stem, overview] : overviews_) {
    text += (text.empty() ? "" : ", ") + (folder_ / (stem + ".png")).string();
  }
  return text + "; a contact sheet for each result beside them";
}

}  // namespace spool::tools
