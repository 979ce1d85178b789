#include "lib/image_io/exr_image.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include <Imath/half.h>

#include "lib/image_io/exr_planes.h"

namespace spool {
namespace {

bool representable(double value, PixelType type) {
  switch (type) {
    case PixelType::kUint:
      return value >= 0.0 && value <= 4294967295.0 && std::floor(value) == value;
    case PixelType::kHalf:
      return !std::isfinite(value) || std::abs(value) < 65520.0;  // rounds to at most 65504
    case PixelType::kFloat:
      return !std::isfinite(value) || std::abs(value) <= std::numeric_limits<float>::max();
  }
  return false;
}

Result<void> check_writable(const std::string& name, const ExrFile& image) {
  std::set<std::string_view> names;
  if (image.width < 1 || image.height < 1 || image.channels.empty()) {
    return fail(ErrorCode::kData,
                "{}: an image of {} x {} pixels and {} channels: nothing to write", name,
                image.width, image.height, image.channels.size());
  }
  for (const NamedPlane& channel : image.channels) {
    if (channel.name.empty() || !names.insert(channel.name).second) {
      return fail(ErrorCode::kData, "{}: channel name '{}' is empty or used twice", name,
                  channel.name);
    }
    if (channel.data.width() != image.width || channel.data.height() != image.height) {
      return fail(ErrorCode::kData, "{}: channel {} is {} x {}, the image {} x {}", name,
                  channel.name, channel.data.width(), channel.data.height(), image.width,
                  image.height);
    }
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (representable(channel.data(x, y), channel.type)) continue;
        return fail(ErrorCode::kData, "{}: channel {} cannot hold {} (pixel {}, {})", name,
                    channel.name, channel.data(x, y), x, y);
      }
    }
  }
  return {};
}

ExrPlanes without_channels(const ExrFile& image) {
  ExrPlanes planes;
  planes.width = image.width;
  planes.height = image.height;
  planes.attributes = {image.text_attributes, image.number_attributes};
  return planes;
}

// The values in the type of their channel, which holds them (check_writable).
ExrPlane to_values(const NamedPlane& channel) {
  ExrPlane plane{channel.name, channel.type, {}};
  const std::size_t bytes = bytes_per_value(channel.type);
  plane.values.resize(bytes * channel.data.size());
  for (std::size_t i = 0; i < channel.data.size(); ++i) {
    std::byte* at = plane.values.data() + bytes * i;
    if (channel.type == PixelType::kUint) {
      const auto value = static_cast<std::uint32_t>(channel.data[i]);
      std::memcpy(at, &value, sizeof value);
    } else if (channel.type == PixelType::kHalf) {
      const Imath::half value(static_cast<float>(channel.data[i]));
      std::memcpy(at, &value, sizeof value);
    } else {
      const auto value = static_cast<float>(channel.data[i]);
      std::memcpy(at, &value, sizeof value);
    }
  }
  return plane;
}

}  // namespace

const Plane* ExrFile::find(std::string_view name) const {
  for (const NamedPlane& channel : channels) {
    if (channel.name == name) return &channel.data;
  }
  return nullptr;
}

Result<ExrFile> read_exr(const std::filesystem::path& path, const ExrReadLimits& limits) {
  SPOOL_ASSIGN(ExrSource source, ExrSource::open(path, limits));
  SPOOL_TRY(source.check_single_part());
  return read_part(source, 0);
}

Result<ExrFile> read_part(ExrSource& source, std::size_t p) {
  const ExrPart& part = source.parts()[p];
  SPOOL_ASSIGN(std::vector<ExrPlane> planes, source.read_all(p));
  ExrFile file;
  file.width = static_cast<int>(part.data.width);
  file.height = static_cast<int>(part.data.height);
  file.text_attributes = part.attributes.texts;
  file.number_attributes = part.attributes.numbers;
  for (ExrPlane& plane : planes) {
    file.channels.push_back({plane.name, plane.type, to_doubles(plane, file.width, file.height)});
    plane.values = {};
  }
  return file;
}

Result<void> write_exr(const std::filesystem::path& path, const ExrFile& image,
                       const ExrWriteOptions& options) {
  SPOOL_TRY(check_writable(path.string(), image));
  ExrPlanes planes = without_channels(image);
  for (const NamedPlane& channel : image.channels)
    planes.planes.push_back(to_values(channel));
  return write_exr_planes(path, planes, options);
}

Result<void> write_exr(const std::filesystem::path& path, ExrFile&& image,
                       const ExrWriteOptions& options) {
  SPOOL_TRY(check_writable(path.string(), image));
  ExrPlanes planes = without_channels(image);
  for (NamedPlane& channel : image.channels) {
    planes.planes.push_back(to_values(channel));
    channel.data = Plane();
  }
  return write_exr_planes(path, planes, options);
}

ExrFile exr_from_rgb(RgbImage rgb) {
  ExrFile file{rgb[0].width(), rgb[0].height(), {}};
  for (std::size_t c = 0; c < 3; ++c)
    file.channels.push_back({std::string(1, "RGB"[c]), PixelType::kFloat, std::move(rgb[c])});
  return file;
}

ExrFile exr_from_plane(std::string channel, Plane plane, PixelType type) {
  ExrFile file{plane.width(), plane.height(), {}};
  file.channels.push_back({std::move(channel), type, std::move(plane)});
  return file;
}

Plane to_doubles(const ExrPlane& plane, int width, int height) {
  Plane data(width, height);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::byte* at = plane.values.data() + i * bytes_per_value(plane.type);
    if (plane.type == PixelType::kHalf) {
      Imath::half value;
      std::memcpy(&value, at, sizeof value);
      data[i] = static_cast<double>(static_cast<float>(value));
    } else if (plane.type == PixelType::kUint) {
      std::uint32_t value = 0;
      std::memcpy(&value, at, sizeof value);
      data[i] = static_cast<double>(value);
    } else {
      float value = 0.0f;
      std::memcpy(&value, at, sizeof value);
      data[i] = static_cast<double>(value);
    }
  }
  return data;
}

}  // namespace spool
