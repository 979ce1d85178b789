#include "lib/exchange/sample_image.h"

#include <algorithm>
#include <cstring>

#include "formats/record_layout.h"

namespace spool::exchange {
namespace {

double samples_of(const ExrPart& part) {
  double samples = 1;
  for (const auto& [key, text] : part.attributes.texts)
    if (key.starts_with("cycles.") && key.ends_with(".samples"))
      samples = std::max(samples, std::strtod(text.c_str(), nullptr));
  const bool ours = part.attributes.numbers.contains("spoolVersion");
  if (const auto found = part.attributes.numbers.find("samplesPerPixel");
      !ours && found != part.attributes.numbers.end())
    samples = std::max(samples, found->second);
  return samples;
}

Result<void> check_alike(const std::vector<ExrPart>& parts, const std::vector<ExrPart>& first,
                         const std::string& file) {
  if (parts.size() != first.size())
    return fail(ErrorCode::kData, "{}: {} parts, the first image has {}: save them alike", file,
                parts.size(), first.size());
  for (size_t p = 0; p < parts.size(); ++p) {
    if (const double samples = samples_of(parts[p]); samples > 1)
      return fail(ErrorCode::kData, "{}: holds {} samples per pixel: not a sample record", file,
                  samples);
    if (parts[p].data != first[p].data)
      return fail(ErrorCode::kData, "{}: another data window than the first image: save them alike",
                  file);
    if (parts[p].channels != first[p].channels || parts[p].name != first[p].name)
      return fail(ErrorCode::kData, "{}: other channels than the first image: save them alike",
                  file);
  }
  return {};
}

// Three floats each; a value that is not finite makes its pixel so.
void convert_colours(const ColourMatrix& matrix, std::vector<std::byte>& values) {
  for (size_t at = 0; at < values.size(); at += 3 * sizeof(float)) {
    std::array<float, 3> from{}, to{};
    std::memcpy(from.data(), &values[at], sizeof from);
    for (size_t r = 0; r < 3; ++r) {
      double sum = 0;
      for (size_t c = 0; c < 3; ++c)
        sum += matrix[r][c] * static_cast<double>(from[c]);
      to[r] = static_cast<float>(sum);
    }
    std::memcpy(&values[at], to.data(), sizeof to);
  }
}

}  // namespace

Result<void> check_size(const ExrWindow& window, const std::string& file) {
  constexpr auto kMost = static_cast<int64_t>(format::kMaxSide);
  if (window.width >= 1 && window.height >= 1 && window.width <= kMost && window.height <= kMost)
    return {};
  return fail(ErrorCode::kData, "{}: {} x {} pixels: a recording has 1 to {} each way", file,
              window.width, window.height, kMost);
}

Result<SampleImage> read_sample_image(const std::filesystem::path& path,
                                      const std::vector<ExrPart>& first,
                                      const ExrMapping& mapping) {
  SPOOL_ASSIGN(ExrSource source, ExrSource::open(path));
  SPOOL_TRY(check_alike(source.parts(), first, source.name()));
  SampleImage image{{}, source.parts()[0].attributes, {}};
  for (const MappedLayer& layer : mapping.layers) {
    const size_t part = layer.planes[0].first;
    if (const std::string& lossy = source.parts()[part].lossy; !lossy.empty())
      image.lossy.insert(lossy);
    std::vector<size_t> channels;
    for (const auto& [ignored, channel] : layer.planes)
      channels.push_back(channel);
    if (layer.is_colour()) {
      SPOOL_ASSIGN(const auto conversion,
                   conversion_to_rec709(source.parts()[part], source.name()));
      if (conversion != layer.conversion)
        return fail(ErrorCode::kData, "{}: another colour space than the first image: convert both",
                    source.name());
    }
    SPOOL_ASSIGN(const auto planes, source.read(part, channels));
    image.layers.push_back(interleaved(planes, layer.type));
    if (layer.conversion) convert_colours(layer.conversion->matrix, image.layers.back());
  }
  return image;
}

}  // namespace spool::exchange
