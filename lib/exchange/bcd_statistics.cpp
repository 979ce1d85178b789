#include "lib/exchange/bcd_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "formats/file_set.h"
#include "formats/spool_reader.h"
#include "lib/core/image.h"
#include "lib/image_io/counts_exr.h"
#include "lib/image_io/exr_image.h"

namespace spool::exchange {

using interchange::ExportReport;

namespace {

struct BcdStatisticsOptions : interchange::ExportOptions {
  int spp = 0;            // the first so many of each pixel; 0: all
  std::string selection;  // or an image of counts, channel n
};

constexpr int kBcdBins = 20;
constexpr double kGamma = 2.2;
constexpr double kMaxValue = 2.5;
constexpr double kSaturation = 2.0;  // of the scaled value
constexpr int kLastLinear = kBcdBins - 2;

// Pairs of components, in the order of the file: xx, yy, zz, yz, xz, xy.
constexpr std::array<std::array<int, 2>, 6> kPairs = {
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

struct Images {
  RgbImage mean;
  std::array<Plane, 6> covariance;
  std::vector<Plane> histogram;  // 3 * kBcdBins, then the count

  Images(int width, int height) : mean(make_rgb(width, height)) {
    covariance.fill(Plane(width, height));
    histogram.assign(3 * kBcdBins + 1, Plane(width, height));
  }
};

// Adds one sample of one component to its histogram: two neighbouring bins share a weight of 1.
// The component is taken to the power 1/2.2 and divided by 2.5; what lies beyond 1 goes to the last
// two bins.
void add_to_histogram(double value, std::span<double, kBcdBins> bins) {
  const double scaled =
      std::min(std::pow(std::max(value, 0.0), 1.0 / kGamma) / kMaxValue, kSaturation);
  const double place = scaled * kLastLinear;
  const auto bin = static_cast<int>(std::floor(place));
  if (bin < kLastLinear) {
    bins[static_cast<size_t>(bin)] += 1.0 - (place - bin);
    bins[static_cast<size_t>(bin) + 1] += place - bin;
  } else {
    bins[kLastLinear] += kSaturation - scaled;
    bins[kLastLinear + 1] += scaled - 1.0;
  }
}

// samples[c * stride + s], s < n
void add_pixel(std::span<const float> samples, size_t stride, uint32_t n, int x, int y,
               Images& images) {
  std::array<double, 3> mean{};
  for (size_t c = 0; c < 3; ++c) {
    for (uint32_t s = 0; s < n; ++s)
      mean[c] += static_cast<double>(samples[c * stride + s]);
    mean[c] /= n;
    images.mean[c](x, y) = mean[c];
  }
  for (size_t p = 0; p < kPairs.size(); ++p) {
    const auto a = static_cast<size_t>(kPairs[p][0]), b = static_cast<size_t>(kPairs[p][1]);
    double sum = 0;  // two passes: squares of bright samples would cancel
    for (uint32_t s = 0; s < n; ++s)
      sum += (static_cast<double>(samples[a * stride + s]) - mean[a]) *
             (static_cast<double>(samples[b * stride + s]) - mean[b]);
    images.covariance[p](x, y) = sum / (n - 1);
  }
  for (size_t c = 0; c < 3; ++c) {
    std::array<double, kBcdBins> bins{};
    for (uint32_t s = 0; s < n; ++s)
      add_to_histogram(static_cast<double>(samples[c * stride + s]), bins);
    for (size_t b = 0; b < kBcdBins; ++b)
      images.histogram[c * kBcdBins + b](x, y) = bins[b];
  }
  images.histogram.back()(x, y) = n;
}

Result<CountImage> read_counts(const std::filesystem::path& path,
                               const format::DumpHeader& header) {
  SPOOL_ASSIGN(const ExrFile file, read_counts_exr(path, NeededSize{header.width, header.height}));
  SPOOL_ASSIGN(const std::size_t channel, count_channel(file, path.string()));
  const Plane& counts = file.channels[channel].data;
  CountImage image(file.width, file.height);
  for (size_t i = 0; i < image.size(); ++i) {
    const double n = counts[i];
    if (!(n >= 0 && n <= header.spp && n == std::floor(n)))
      return fail(ErrorCode::kData, "{}: count {} (pixel {},{}): 0 to {} were recorded",
                  path.string(), n, i % static_cast<size_t>(file.width),
                  i / static_cast<size_t>(file.width), header.spp);
    image[i] = static_cast<std::int32_t>(n);
  }
  return image;
}

Result<void> add_tile(const format::SpoolReader& dump, uint32_t tile, const CountImage& counts,
                      Images& images) {
  const format::PixelRect rect = dump.tile_rect(tile);
  std::int32_t most = 0;
  for (uint32_t y = rect.y0; y < rect.y1; ++y)
    for (uint32_t x = rect.x0; x < rect.x1; ++x)
      most = std::max(most, counts(static_cast<int>(x), static_cast<int>(y)));
  const auto read = static_cast<uint32_t>(std::max(1, most));
  SPOOL_ASSIGN(const auto samples, dump.read_region("radiance", rect, 0, read));
  const size_t stride = size_t{rect.width()} * rect.height() * read;
  for (uint32_t y = rect.y0; y < rect.y1; ++y)
    for (uint32_t x = rect.x0; x < rect.x1; ++x) {
      const auto n = static_cast<uint32_t>(counts(static_cast<int>(x), static_cast<int>(y)));
      if (n < 2)
        return fail(ErrorCode::kData,
                    "{}: {} samples (pixel {},{}): BCD needs two for a covariance",
                    dump.path().string(), n, x, y);
      const size_t at = (size_t{y - rect.y0} * rect.width() + x - rect.x0) * read;
      for (size_t c = 0; c < 3; ++c)
        for (uint32_t s = 0; s < n; ++s)
          if (!std::isfinite(samples[c * stride + at + s]))
            return fail(ErrorCode::kData,
                        "{}: not finite (pixel {},{} sample {}): BCD has no place for it",
                        dump.path().string(), x, y, s);
      add_pixel(std::span(samples).subspan(at), stride, n, static_cast<int>(x), static_cast<int>(y),
                images);
    }
  return {};
}

ExrFile bins_file(std::span<const Plane> planes) {
  ExrFile file{planes[0].width(), planes[0].height(), {}};
  for (size_t i = 0; i < planes.size(); ++i)
    file.channels.push_back({fmt::format("Bin_{:04}", i), PixelType::kFloat, planes[i]});
  return file;
}

bool is_grey(const RgbImage& rgb) {
  for (size_t i = 0; i < rgb[0].size(); ++i) {
    const auto r = static_cast<float>(rgb[0][i]);
    if (r != static_cast<float>(rgb[1][i]) || r != static_cast<float>(rgb[2][i])) return false;
  }
  return true;
}

Result<ExportReport> export_bcd_statistics(const std::filesystem::path& in,
                                           const std::filesystem::path& out,
                                           const BcdStatisticsOptions& options) {
  if (options.spp > 0 && !options.selection.empty())
    return fail(ErrorCode::kUsage, "export bcd-stats: spp and selection: give one of them");
  std::filesystem::path base = out;
  if (base.extension() == ".exr") base.replace_extension();
  const std::string stem = base.filename().string();
  if (stem.empty() || stem == "." || stem == ".." || stem == ".exr")
    return fail(ErrorCode::kUsage, "{}: names no file: give P or P.exr", out.string());
  const std::array<std::string, 3> names = {stem + ".exr", stem + "_cov.exr", stem + "_hist.exr"};
  SPOOL_ASSIGN(format::FileSet set,
               format::FileSet::create(base.parent_path(), {names.begin(), names.end()},
                                       options.force, {in, options.selection}));
  SPOOL_ASSIGN(const format::SpoolReader dump, format::SpoolReader::open(in));
  const format::DumpHeader& header = dump.header();
  const int width = static_cast<int>(header.width), height = static_cast<int>(header.height);
  if (options.spp > static_cast<int>(header.spp))
    return fail(ErrorCode::kUsage, "{}: {} samples asked for, {} recorded: ask for fewer",
                in.string(), options.spp, header.spp);
  CountImage counts(width, height, options.spp == 0 ? static_cast<int>(header.spp) : options.spp);
  if (!options.selection.empty()) {
    SPOOL_ASSIGN(counts, read_counts(options.selection, header));
  }
  Images images(width, height);
  for (uint32_t tile = 0; tile < dump.tiles(); ++tile)
    SPOOL_TRY(add_tile(dump, tile, counts, images));
  ExportReport report;
  if (is_grey(images.mean)) {
    // bcd_cli takes three equal channels for a grey image and returns wrong colours.
    const auto blue = static_cast<float>(images.mean[2](0, 0));
    images.mean[2](0, 0) =
        static_cast<double>(std::nextafter(blue, std::numeric_limits<float>::infinity()));
    report.notes.push_back(
        "the image is grey: blue of pixel 0,0 was raised by one step, or bcd_cli misreads it");
  }
  for (const format::LayerInfo& layer : dump.layers())
    if (layer.name != "radiance")
      report.notes.push_back(layer.name + " is not written: BCD takes radiance only");
  const std::array<ExrFile, 3> files = {exr_from_rgb(images.mean), bins_file(images.covariance),
                                        bins_file(images.histogram)};
  for (size_t i = 0; i < files.size(); ++i)
    SPOOL_TRY(set.write(
        names[i], [&](const std::filesystem::path& path) { return write_exr(path, files[i]); }));
  SPOOL_TRY(set.publish());
  return report;
}

}  // namespace

interchange::ExportFormat bcd_statistics_target() {
  using O = BcdStatisticsOptions;
  return interchange::export_format<O>(
      "bcd-stats", "what BCD's denoiser reads: P.exr, P_cov.exr, P_hist.exr",
      {integer_option<O>("spp", &O::spp, 0, format::kMaxSpp,
                         "the first so many samples of each pixel; 0: all"),
       interchange::text_option<O>("selection", &O::selection, "FILE.exr",
                                   "instead: an image of counts, as spool replay writes it")},
      export_bcd_statistics);
}

}  // namespace spool::exchange
