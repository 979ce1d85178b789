#include "tools/verbs/mask_files.h"

#include <algorithm>
#include <filesystem>

#include "formats/spool_reader.h"
#include "lib/image_io/foreign_picture.h"

namespace spool::tools {

namespace {

// A single channel, or the mean of R, G and B.
Result<Plane> read_mask(const std::string& path, const std::optional<NeededSize>& needed) {
  SPOOL_ASSIGN(const ForeignPicture picture, read_single_or_picture(path, kNoLayerOption, needed));
  const RgbImage& rgb = picture.rgb;
  Plane mask(rgb[0].width(), rgb[0].height());
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = (rgb[0][i] + rgb[1][i] + rgb[2][i]) / 3.0;
  return mask;
}

}  // namespace

Result<std::vector<EnergyMask>> read_energy_masks(const std::vector<std::string>& texts,
                                                  const NeededSize& needed) {
  std::vector<EnergyMask> masks;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      return fail(ErrorCode::kUsage, "--mask {}: write NAME=FILE.exr", text);
    }
    if (std::ranges::find(masks, text.substr(0, equals), &EnergyMask::name) != masks.end())
      return fail(ErrorCode::kUsage, "--mask {}: the name is there twice: choose another", text);
    EnergyMask mask{text.substr(0, equals), "", text.substr(equals + 1), {}};
    SPOOL_ASSIGN(mask.plane, read_mask(mask.path, needed));
    masks.push_back(std::move(mask));
  }
  return masks;
}

Result<void> read_masks(Plan& plan) {
  for (EnergyMask& mask : plan.experiment.masks) {
    for (const std::string& recording : plan.recordings) {
      if (!mask.recording.empty() &&
          std::filesystem::path(recording).filename().string() != mask.recording)
        continue;
      SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(recording));
      const NeededSize needed{reader.header().width, reader.header().height, recording};
      if (mask.plane.width() == needed.width && mask.plane.height() == needed.height)
        continue;  // it was read for another recording of that size
      SPOOL_ASSIGN(mask.plane, read_mask(mask.path, needed));
    }
  }
  return {};
}

}  // namespace spool::tools
