#include "tools/batch/evaluation_pictures.h"

#include <algorithm>
#include <span>

#include "formats/crc32.h"
#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/image_io/png_writer.h"
#include "tools/batch/kept_images.h"
#include "tools/methods/replicate_images.h"
#include "tools/verbs/result_pictures.h"

namespace spool::tools {
namespace {

// Of a file name, which may have 255 bytes with its ending.
constexpr std::size_t kLongestStem = 200;

constexpr std::size_t kLargestSheet = 24;  // estimates

// The estimates of one recording and budget, side by side.
struct Sheet {
  const Cell* first = nullptr;
  std::vector<const PicturedResult*> results;
};

std::vector<Sheet> sheets_of(const std::vector<PicturedResult>& results) {
  std::vector<Sheet> sheets;
  std::map<std::pair<std::string, double>, std::size_t> index;
  for (const PicturedResult& result : results) {
    const auto [place, fresh] =
        index.try_emplace({result.cell.dump, result.cell.spp}, sheets.size());
    if (fresh) sheets.push_back({&result.cell, {}});
    sheets[place->second].results.push_back(&result);
  }
  return sheets;
}

Result<RgbImage> read_rgb(const std::filesystem::path& path) {
  return read_picture(path).map([](ForeignPicture picture) { return std::move(picture.rgb); });
}

}  // namespace

EvaluationPictures::EvaluationPictures(std::filesystem::path folder,
                                       const std::vector<std::string>& dumps)
    : folder_(std::move(folder)) {
  for (const std::string& dump : dumps) {
    const std::string stem = file_name_of(std::filesystem::path(dump).stem().string());
    std::string name = stem;
    const auto taken = [&] {
      return std::ranges::any_of(dump_names_,
                                 [&](const auto& entry) { return entry.second == name; });
    };
    for (int i = 2; taken(); ++i)
      name = fmt::format("{}-{}", stem, i);
    dump_names_.try_emplace(dump, name);
  }
}

std::string EvaluationPictures::stem_of(const Cell& cell) const {
  std::string stem =
      fmt::format("{}_{}_{}_{:g}spp", dump_names_.at(cell.dump), file_name_of(cell.sampler.label()),
                  file_name_of(cell.filter.label()), cell.spp);
  if (stem.size() <= kLongestStem) return stem;
  return fmt::format("{}-{:08x}", stem.substr(0, kLongestStem - 9),
                     format::crc32(std::as_bytes(std::span(stem))));
}

Result<void> EvaluationPictures::add(const CellResult& result, const CellImages& images) {
  const Cell& cell = result.cell;
  if (cell.replicate != 0) return {};
  ResultImages kept =
      images_of(fmt::format("{}  {} + {}  {:g} spp  relMSE {:.3g}", dump_names_.at(cell.dump),
                            cell.sampler.label(), cell.filter.label(), cell.spp,
                            result.metrics["relmse"].value),
                images.reconstruction, images.selection.statistics.n, &images.reference);
  if (!result.metrics.flip.empty()) kept.flip = result.metrics.flip;
  const std::string stem = stem_of(cell);
  remove_images(folder_, stem);
  std::error_code status;
  std::filesystem::create_directories(folder_ / stem, status);
  SPOOL_TRY(write_reference(result, images, stem));
  return write_result_numbers(folder_ / stem, kept,
                              image_attributes(kept.title, cell.spp, dump_names_.at(cell.dump)),
                              {.overwrite = true, .shared = true});
}

void EvaluationPictures::remove(const Cell& cell) const {
  const std::string stem = stem_of(cell);
  remove_images(folder_, stem);
  std::error_code status;
  std::filesystem::remove(folder_ / stem, status);  // where it is empty
}

void EvaluationPictures::remove_all(const Plan& plan) const {
  std::error_code status;
  for (const std::string& dump : plan.recordings) {
    std::filesystem::remove(reference_of(dump), status);
    for (const double spp : plan.spp) {
      std::filesystem::remove(sheet_of(dump, spp), status);
      for (const MethodChoice& sampler : plan.samplers)
        for (const MethodChoice& filter : plan.filters)
          remove({dump, sampler, filter, spp});
    }
  }
}

std::filesystem::path EvaluationPictures::reference_of(const std::string& dump) const {
  return folder_ / (dump_names_.at(dump) + "_reference.exr");
}

std::filesystem::path EvaluationPictures::sheet_of(const std::string& dump, double spp) const {
  return folder_ / fmt::format("{}_{:g}spp.png", dump_names_.at(dump), spp);
}

// Every result has its own reference where that is made of the samples it did not take.
Result<void> EvaluationPictures::write_reference(const CellResult& result, const CellImages& images,
                                                 const std::string& stem) {
  const bool own = result.reference == ReferenceKind::kLeaveSelectedOut;
  if (!own && !referenced_.insert(result.cell.dump).second) return {};
  return write_exr(own ? folder_ / stem / "reference.exr" : reference_of(result.cell.dump),
                   exr_from_rgb(images.reference.mean), {.overwrite = true, .shared = true});
}

Result<std::string> EvaluationPictures::write_sheets(
    const std::vector<PicturedResult>& results) const {
  std::string written;
  bool any_larger = false;
  for (const Sheet& sheet : sheets_of(results)) {
    if (sheet.results.size() > kLargestSheet) {
      any_larger = true;
      std::error_code none;  // of the plan before it grew: it shows some of these results only
      std::filesystem::remove(sheet_of(sheet.first->dump, sheet.first->spp), none);
      continue;
    }
    const std::string& dump = dump_names_.at(sheet.first->dump);
    std::filesystem::path reference = folder_ / stem_of(*sheet.first) / "reference.exr";
    if (!std::filesystem::exists(reference)) reference = reference_of(sheet.first->dump);
    const Result<RgbImage> judge = read_rgb(reference);
    if (!judge) continue;  // pictures were switched off when these cells ran
    const double exposure = tone_exposure(*judge);
    std::vector<Panel> panels = {{"reference", tone_map(*judge, exposure), {}}};
    for (const PicturedResult* result : sheet.results) {
      const Result<RgbImage> image = read_rgb(folder_ / stem_of(result->cell) / "estimate.exr");
      if (!image) continue;
      panels.push_back(
          {fmt::format("{} + {}", result->cell.sampler.label(), result->cell.filter.label()),
           tone_map(*image, exposure), Caption{fmt::format("relMSE {:.3g}", result->relmse)}});
    }
    const auto path = sheet_of(sheet.first->dump, sheet.first->spp);
    const std::string heading = fmt::format("{}  {:g} sample{} per pixel", dump, sheet.first->spp,
                                            sheet.first->spp == 1.0 ? "" : "s");
    SPOOL_TRY(write_png(path, contact_sheet(heading, panels), true, true));
    written += (written.empty() ? "" : ", ") + path.string();
  }
  if (any_larger) {
    written += fmt::format("{}no sheet of more than {} estimates: spool figure draws some of them",
                           written.empty() ? "" : "; ", kLargestSheet);
  }
  return written;
}

Result<void> check_picture_names(const Plan& plan) {
  const EvaluationPictures pictures({}, plan.recordings);
  std::map<std::string, std::string> known;  // stem: result
  for (const std::string& dump : plan.recordings) {
    for (const MethodChoice& sampler : plan.samplers) {
      for (const MethodChoice& filter : plan.filters) {
        for (const double spp : plan.spp) {
          const std::string stem = pictures.stem_of({dump, sampler, filter, spp});
          const std::string result =
              fmt::format("{}, {} + {} at {} spp", dump, sampler.label(), filter.label(), spp);
          const auto [at, fresh] = known.try_emplace(stem, result);
          if (fresh || at->second == result) continue;
          return fail(ErrorCode::kUsage,
                      "{} and {}: their images would have one name, {}: give one another label, or "
                      "--no-pictures",
                      at->second, result, stem);
        }
      }
    }
  }
  return {};
}

}  // namespace spool::tools
