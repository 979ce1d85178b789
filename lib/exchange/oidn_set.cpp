#include "lib/exchange/oidn_set.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/file_set.h"
#include "formats/layer_components.h"
#include "formats/spool_reader.h"
#include "lib/core/image.h"
#include "lib/image_io/exr_image.h"

namespace spool::exchange {

using format::LayerInfo;
using format::Scope;
using interchange::ExportReport;

namespace {

struct OidnSetOptions : interchange::ExportOptions {
  std::vector<uint32_t> spp;  // of the inputs; empty: 1, 2, 4, ... up to what was recorded
  std::string name;           // empty: the stem of the recording
};

struct Feature {
  const char* layer;
  const char* components;
  const char* suffix;
  double lowest, highest;  // what OIDN's loader cuts off
};
constexpr Feature kFeatures[] = {{"radiance", "RGB", "hdr", 0.0, HUGE_VAL},
                                 {"albedo", "RGB", "alb", 0.0, 1.0},
                                 {"normal", "XYZ", "nrm", -1.0, 1.0}};

// Means of the first n samples, for every n of `counts` (ascending).
Result<std::vector<RgbImage>> prefix_means(const format::SpoolReader& dump, const char* layer,
                                           const std::vector<uint32_t>& counts) {
  const int width = static_cast<int>(dump.header().width);
  const int height = static_cast<int>(dump.header().height);
  std::vector<RgbImage> means(counts.size(), make_rgb(width, height));
  const size_t most = counts.back();
  for (uint32_t tile = 0; tile < dump.tiles(); ++tile) {
    const format::PixelRect rect = dump.tile_rect(tile);
    SPOOL_ASSIGN(const auto samples, dump.read_region(layer, rect, 0, counts.back()));
    size_t at = 0;
    for (size_t c = 0; c < 3; ++c)
      for (uint32_t y = rect.y0; y < rect.y1; ++y)
        for (uint32_t x = rect.x0; x < rect.x1; ++x, at += most) {
          double sum = 0;
          size_t s = 0;
          for (size_t k = 0; k < counts.size(); ++k) {
            for (; s < counts[k]; ++s) {
              if (!std::isfinite(samples[at + s]))
                return fail(
                    ErrorCode::kData,
                    "{}: {} is not finite (pixel {},{} sample {}): OIDN would take it for 0",
                    dump.path().string(), layer, x, y, s);
              sum += static_cast<double>(samples[at + s]);
            }
            means[k][c](static_cast<int>(x), static_cast<int>(y)) = sum / counts[k];
          }
        }
  }
  return means;
}

uint64_t outside(const RgbImage& image, const Feature& feature) {
  uint64_t count = 0;
  for (const Plane& plane : image)
    for (const double value : plane.pixels())
      count += value < feature.lowest || value > feature.highest;
  return count;
}

Result<RgbImage> reference_image(const format::SpoolReader& dump) {
  const auto layer = dump.find_layer("reference");
  if (!layer || layer->scope != Scope::kPixel || !has_components(*layer, "RGB"))
    return fail(ErrorCode::kData,
                "{}: no reference from other seeds: the largest input would become the target; "
                "record one",
                dump.path().string());
  SPOOL_ASSIGN(const auto values, dump.read_pixel_layer("reference"));
  RgbImage image =
      make_rgb(static_cast<int>(dump.header().width), static_cast<int>(dump.header().height));
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      return fail(ErrorCode::kData, "{}: the reference is not finite: OIDN would take it for 0",
                  dump.path().string());
    image[i / image[0].size()][i % image[0].size()] = static_cast<double>(values[i]);
  }
  return image;
}

std::string file_name(const std::string& name, const std::string& stem, const Feature& feature) {
  return fmt::format("{}_{}.{}.exr", name, stem, feature.suffix);
}

// The counts of samples, ascending.
Result<std::vector<uint32_t>> counts_of(const OidnSetOptions& options, uint32_t recorded,
                                        const std::string& in) {
  std::vector<uint32_t> counts = options.spp;
  if (counts.empty())
    for (uint32_t n = 1; n <= recorded; n *= 2)
      counts.push_back(n);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  if (counts.front() < 1 || counts.back() > recorded)
    return fail(ErrorCode::kUsage, "{}: {} samples asked for, 1 to {} are possible", in,
                counts.front() < 1 ? counts.front() : counts.back(), recorded);
  return counts;
}

bool is_recorded(const format::SpoolReader& dump, const Feature& feature) {
  const auto layer = dump.find_layer(feature.layer);
  return layer && layer->scope == Scope::kSample && has_components(*layer, feature.components);
}

// Of NAME_0008spp.hdr.exr and the like in `out`, whatever their counts: the trainer would take
// those of an earlier set for inputs of this one.
void add_earlier_images(const std::filesystem::path& out, const std::string& name,
                        std::vector<std::string>& names) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(out, ignored)) {
    const std::string found = entry.path().filename().string();
    if (!found.starts_with(name + "_") || std::ranges::count(names, found) > 0) continue;
    const std::string rest = found.substr(name.size() + 1), stem = rest.substr(0, rest.find('.'));
    const bool counted = stem.ends_with("spp") && stem.size() > 3 &&
                         stem.find_first_not_of("0123456789") == stem.size() - 3;
    for (const Feature& feature : kFeatures)
      if ((counted || stem == "ref") && found == file_name(name, stem, feature))
        names.push_back(found);
  }
}

// `out`, made where it is not there, and the set in it: its target comes first, since without one
// the largest input would be it.
Result<format::FileSet> begin_set(const std::filesystem::path& in, const std::filesystem::path& out,
                                  const std::vector<std::string>& stems, const std::string& name,
                                  const format::SpoolReader& dump, bool force) {
  if (name.find('/') != std::string::npos)
    return fail(ErrorCode::kUsage, "export oidn: name '{}' has a '/': the folder is that of -o",
                name);
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error)
    return fail(ErrorCode::kIo, "{}: cannot be made ({}): check the path", out.string(),
                error.message());
  std::vector<std::string> names;
  for (const std::string& stem : stems)
    for (const Feature& feature : kFeatures)
      if (is_recorded(dump, feature)) names.push_back(file_name(name, stem, feature));
  add_earlier_images(out, name, names);
  return format::FileSet::create(out, std::move(names), force, {in});
}

Result<ExportReport> export_oidn_set(const std::filesystem::path& in,
                                     const std::filesystem::path& out,
                                     const OidnSetOptions& options) {
  SPOOL_ASSIGN(const format::SpoolReader dump, format::SpoolReader::open(in));
  SPOOL_ASSIGN(const RgbImage reference, reference_image(dump));
  const uint32_t recorded = dump.header().spp;
  SPOOL_ASSIGN(const auto counts, counts_of(options, recorded, in.string()));
  const std::string name = options.name.empty() ? in.stem().string() : options.name;
  // The last name in sorted order is the target: counts of one width, then "ref".
  const size_t digits = std::max<size_t>(4, std::to_string(counts.back()).size());
  std::vector<std::string> stems = {"ref"};
  for (const uint32_t count : counts)
    stems.push_back(fmt::format("{:0{}}spp", count, digits));
  SPOOL_ASSIGN(format::FileSet set, begin_set(in, out, stems, name, dump, options.force));
  const auto write = [&](const std::string& stem, const Feature& feature, const RgbImage& image) {
    return set.write(file_name(name, stem, feature), [&](const std::filesystem::path& path) {
      return write_exr(path, exr_from_rgb(image));
    });
  };
  ExportReport report;
  for (const Feature& feature : kFeatures) {
    const bool light = feature.layer == kFeatures[0].layer;
    if (!is_recorded(dump, feature)) {
      report.notes.push_back(fmt::format("no {}: not recorded as {} of each sample", feature.layer,
                                         feature.components));
      continue;
    }
    std::vector<uint32_t> wanted = counts;
    if (!light && wanted.back() != recorded) wanted.push_back(recorded);  // for the target
    SPOOL_ASSIGN(const auto means, prefix_means(dump, feature.layer, wanted));
    uint64_t cut = 0;
    for (size_t k = 0; k < counts.size(); ++k) {
      cut += outside(means[k], feature);
      SPOOL_TRY(write(stems[k + 1], feature, means[k]));
    }
    SPOOL_TRY(write("ref", feature, light ? reference : means.back()));
    if (cut > 0)
      report.notes.push_back(fmt::format("{}: {} values lie outside [{}, {}]: OIDN will cut them",
                                         feature.layer, cut, feature.lowest, feature.highest));
  }
  for (const LayerInfo& layer : dump.layers()) {
    const bool taken = layer.name == "reference" ||
                       std::any_of(std::begin(kFeatures), std::end(kFeatures),
                                   [&](const Feature& f) { return layer.name == f.layer; });
    if (!taken) report.notes.push_back(layer.name + " is not written: OIDN has no name for it");
  }
  SPOOL_TRY(set.publish());
  return report;
}

}  // namespace

interchange::ExportFormat oidn_target() {
  using O = OidnSetOptions;
  return interchange::export_format<O>(
      "oidn", "a folder of images for Open Image Denoise's trainer",
      {{"spp", "N,N,...", "samples of each pixel in the inputs; empty: 1,2,4 and so on",
        [](O& options, std::string_view text) -> Result<void> {
          options.spp.clear();
          for (std::size_t begin = 0; begin <= text.size();) {
            const std::size_t end = std::min(text.find(',', begin), text.size());
            SPOOL_ASSIGN(const int count, parse_integer("spp", text.substr(begin, end - begin), 1,
                                                        static_cast<int>(format::kMaxSpp)));
            options.spp.push_back(static_cast<uint32_t>(count));
            begin = end + 1;
          }
          return {};
        },
        [](const O& options) { return fmt::format("{}", fmt::join(options.spp, ",")); }},
       interchange::text_option<O>("name", &O::name, "NAME",
                                   "of the images (that of the recording)")},
      export_oidn_set);
}

}  // namespace spool::exchange
