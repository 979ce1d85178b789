#include "tools/verbs/metrics.h"

#include <cmath>

#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/metrics/energy_masks.h"
#include "lib/pool/reference_check.h"
#include "tools/json/answers_json.h"
#include "tools/verbs/mask_files.h"
#include "tools/verbs/picture_name.h"

namespace spool::tools {
namespace {

// Spool's own images hold the variance beside the picture that it is of.
Result<ForeignPicture> read_variance(const std::filesystem::path& path, const NeededSize& size) {
  auto layer = read_picture(path, {"variance", "", "", ""}, size);
  if (layer || layer.error().code != ErrorCode::kUsage) return layer;
  return read_picture(path, kNoLayerOption, size);
}

Result<void> check_error_map(const MetricsOptions& options, bool force) {
  if (options.error_map.empty()) return {};
  for (const auto& input : {options.image, options.reference, options.variance})
    SPOOL_TRY(format::refuse_own_input(options.error_map, input));
  for (const std::string& mask : options.masks)
    SPOOL_TRY(format::refuse_own_input(options.error_map, mask.substr(mask.find('=') + 1)));
  return refuse_existing(options.error_map, force);
}

struct JudgedPictures {
  RgbImage image;
  JudgingReference reference;
  std::vector<std::string> remarks;  // one line for each file
};

Result<JudgedPictures> read_pictures(const MetricsOptions& options) {
  SPOOL_ASSIGN(const ForeignPicture header, read_picture_header(options.image, options.layer));
  const NeededSize size{header.shown.width, header.shown.height, options.image.string()};
  SPOOL_ASSIGN(ForeignPicture mean, read_picture(options.reference, options.reference_layer, size));
  SPOOL_ASSIGN(ForeignPicture image, read_picture(options.image, options.layer));
  SPOOL_TRY(check_aligned(image, mean, options.image.string(), "the reference"));
  JudgedPictures pictures;
  pictures.remarks = {remark_line(options.image.string(), image.remarks),
                      remark_line(options.reference.string(), mean.remarks)};
  if (!options.variance.empty()) {
    const std::string name = options.variance.string();
    SPOOL_ASSIGN(ForeignPicture variance, read_variance(options.variance, size));
    SPOOL_TRY(check_aligned(variance, mean, name, "the reference"));
    if (!variance.converted_from.empty())
      return fail(ErrorCode::kData,
                  "{}: variances in {} are not those in Rec. 709: estimate them after the "
                  "conversion",
                  name, variance.converted_from);
    SPOOL_TRY(check_variance(variance.rgb, mean.rgb, name));
    pictures.remarks.push_back(remark_line(name, variance.remarks));
    pictures.reference.variance = std::move(variance.rgb);
  }
  pictures.image = std::move(image.rgb);
  pictures.reference.mean = std::move(mean.rgb);
  return pictures;
}

std::string value_text(double value) {
  return std::isnan(value) ? "n/a" : fmt::format("{:.6g}", value);
}

}  // namespace

Result<MetricOptions> metric_settings(const std::vector<std::string>& settings) {
  MetricOptions metric;
  metric.perceptual = Perceptual::kAll;
  for (const std::string& text : settings) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      return fail(ErrorCode::kUsage, "--set {}: write OPTION=VALUE, for example trim=0.01", text);
    }
    const Result<void> set =
        set_option(metric_option_table(), metric, text.substr(0, equals), text.substr(equals + 1));
    if (!set)
      return fail(ErrorCode::kUsage, "--set {}: {}: see spool list metrics", text,
                  set.error().message);
  }
  return metric;
}

Result<void> check_same_size(const RgbImage& image, const RgbImage& reference,
                             const std::string& name) {
  if (image[0].width() == reference[0].width() && image[0].height() == reference[0].height()) {
    return {};
  }
  return fail(ErrorCode::kData, "{}: is {} x {} pixels, the reference {} x {}: crop one of them",
              name, image[0].width(), image[0].height(), reference[0].width(),
              reference[0].height());
}

Result<void> check_finite(const MetricTable& table, const std::string& name,
                          const std::string& reference) {
  const auto were = [](std::uint64_t count) {
    return counted(count, "pixel is not finite and was left out",
                   "pixels are not finite and were left out");
  };
  const std::uint64_t ours = table.excluded_estimate, theirs = table.excluded_reference;
  if (ours == 0 && theirs == 0) return {};
  if (theirs == 0) return fail(ErrorCode::kData, "{}: {}", name, were(ours));
  if (ours == 0) return fail(ErrorCode::kData, "{}: {}", reference, were(theirs));
  return fail(ErrorCode::kData, "{}: {}; {}: {} more", name, were(ours), reference, were(theirs));
}

Result<void> validate(const MetricsOptions& options) {
  if (!options.error_map.empty()) SPOOL_TRY(check_exr_name(options.error_map));
  SPOOL_TRY(metric_settings(options.settings));
  return {};
}

Result<void> run_metrics(const MetricsOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  SPOOL_TRY(check_error_map(options, common.force));
  SPOOL_ASSIGN(const MetricOptions metric, metric_settings(options.settings));
  SPOOL_ASSIGN(const JudgedPictures pictures, read_pictures(options));
  const RgbImage& image = pictures.image;
  const JudgingReference& reference = pictures.reference;
  SPOOL_ASSIGN(const std::vector<EnergyMask> masks,
               read_energy_masks(options.masks,
                                 {image[0].width(), image[0].height(), options.image.string()}));
  for (const std::string& remark : pictures.remarks)
    print_note(remark);
  if (is_the_reference(image, reference.mean))
    print_note(options.image.string() + ": is the reference: its error has no meaning");
  const MetricTable table = error_metrics(image, reference, metric);
  std::vector<std::vector<std::string>> rows = {{"metric", "meaning", "value", "+-"}};
  std::vector<std::pair<std::string, MetricValue>> values;
  const auto add = [&](const std::string& name, const std::string& meaning,
                       const MetricValue& value) {
    rows.push_back({name, meaning, value_text(value.value), value_text(value.standard_error)});
    values.emplace_back(name, value);
  };
  for (std::size_t m = 0; m < metrics().size(); ++m)
    add(metrics()[m].name, metrics()[m].meaning, table.values[m]);
  for (const EnergyMask& mask : masks) {
    SPOOL_ASSIGN(const MetricValue ratio,
                 energy_in_mask(image, reference.mean, mask, metric.bootstrap));
    add("energy_ratio_in_" + mask.name, "energy ratio where the mask is above 0.5", ratio);
  }
  if (common.json) {
    print(metrics_text(options.image, options.reference, values, table));
  } else {
    print(format_columns(rows, 2));
    const char* exact = reference.variance ? ""
                                           : "; the reference taken as exact: nothing is debiased "
                                             "without its --variance";
    print("\n" +
          wrapped(fmt::format("{} judged; relative metrics after a factor {:.4g} on both images "
                              "(--set rel_scale=none: as they are); +- one standard error{}",
                              counted(table.pixels, "pixel"), table.relative_scale, exact),
                  line_width()) +
          "\n");
  }
  if (!options.error_map.empty()) {
    Result<void> written =
        write_exr(options.error_map, exr_from_plane("Y", squared_error_map(image, reference)),
                  {.overwrite = common.force});
    if (!written && written.error().code == ErrorCode::kData)
      written.error().message += ": scale both images down";
    SPOOL_TRY(written);
  }
  return check_finite(table, options.image.string(), options.reference.string());
}

}  // namespace spool::tools
