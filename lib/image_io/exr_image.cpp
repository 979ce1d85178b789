#include "lib/image_io/exr_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <set>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>

#include "lib/image_io/atomic_file.h"

namespace spool {
namespace {

// No codec of OpenEXR reaches this ratio on real data (deflate ends at 1032:1), so a header that
// claims more than this times the length of its file lies.
constexpr std::uint64_t kMaxExpansion = 4096;

constexpr int kMaxSide = 1 << 20;

PixelType pixel_type(Imf::PixelType type) {
  return type == Imf::HALF ? PixelType::kHalf
                           : (type == Imf::UINT ? PixelType::kUint : PixelType::kFloat);
}

// The geometry of a part, believed only after every check here.
Result<ExrFile> checked_geometry(const std::string& name, const Imf::Header& header,
                                 std::uint64_t file_bytes, const ExrReadLimits& limits) {
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE) {
    return fail(ErrorCode::kData, "{}: a deep EXR (part 0 is '{}'): a flat image is needed", name,
                header.type());
  }
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return fail(ErrorCode::kData, "{}: the data window is {} x {} pixels: the file is not usable",
                name, width, height);
  }
  const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > limits.max_pixels) {
    return fail(ErrorCode::kData, "{}: {} x {} pixels are more than the limit of {}", name, width,
                height, limits.max_pixels);
  }
  ExrFile file;
  file.width = static_cast<int>(width);
  file.height = static_cast<int>(height);
  std::uint64_t pixel_bytes = 0;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    if (i.channel().xSampling != 1 || i.channel().ySampling != 1) {
      return fail(ErrorCode::kData, "{}: channel {} is subsampled: write it at full size", name,
                  i.name());
    }
    file.channels.push_back({i.name(), pixel_type(i.channel().type), {}});
    pixel_bytes += sizeof(double);
  }
  if (file.channels.empty()) return fail(ErrorCode::kData, "{}: has no channels", name);
  if (pixels > limits.max_bytes / std::max<std::uint64_t>(pixel_bytes, 1)) {
    return fail(ErrorCode::kData, "{}: {} channels of {} x {} pixels exceed the limit of {} bytes",
                name, file.channels.size(), width, height, limits.max_bytes);
  }
  if (pixels * pixel_bytes / kMaxExpansion > file_bytes) {
    return fail(ErrorCode::kDamage,
                "{}: claims {} channels of {} x {} pixels in {} bytes: the file is cut or damaged",
                name, file.channels.size(), width, height, file_bytes);
  }
  return file;
}

void read_attributes(const Imf::Header& header, ExrFile& file) {
  for (auto i = header.begin(); i != header.end(); ++i) {
    const Imf::Attribute& attribute = i.attribute();
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
      file.text_attributes[i.name()] = text->value();
    } else if (const auto* real = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) {
      file.number_attributes[i.name()] = real->value();
    } else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) {
      file.number_attributes[i.name()] = static_cast<double>(single->value());
    } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&attribute)) {
      file.number_attributes[i.name()] = integer->value();
    }
  }
}

// 32 bits per value: OpenEXR widens halves to floats, exactly.
struct RawPlane {
  std::vector<float> reals;
  std::vector<std::uint32_t> counts;
};

void read_pixels(Imf::InputPart& part, ExrFile& file) {
  const Imath::Box2i& window = part.header().dataWindow();
  const std::size_t pixels =
      static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height);
  std::vector<RawPlane> raw(file.channels.size());
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < raw.size(); ++c) {
    const bool is_count = file.channels[c].type == PixelType::kUint;
    is_count ? raw[c].counts.resize(pixels) : raw[c].reals.resize(pixels);
    void* base = is_count ? static_cast<void*>(raw[c].counts.data())
                          : static_cast<void*>(raw[c].reals.data());
    buffer.insert(file.channels[c].name,
                  Imf::Slice::Make(is_count ? Imf::UINT : Imf::FLOAT, base, window, 4,
                                   std::size_t{4} * static_cast<std::size_t>(file.width)));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  for (std::size_t c = 0; c < raw.size(); ++c) {
    file.channels[c].data = Plane(file.width, file.height);
    for (std::size_t i = 0; i < pixels; ++i) {
      file.channels[c].data[i] = raw[c].counts.empty() ? static_cast<double>(raw[c].reals[i])
                                                       : static_cast<double>(raw[c].counts[i]);
    }
  }
}

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

Imf::PixelType imf_type(PixelType type) {
  return type == PixelType::kHalf ? Imf::HALF : (type == PixelType::kUint ? Imf::UINT : Imf::FLOAT);
}

void write_pixels(const std::filesystem::path& path, const ExrFile& image) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [key, value] : image.text_attributes) {
    header.insert(key, Imf::StringAttribute(value));
  }
  for (const auto& [key, value] : image.number_attributes) {
    header.insert(key, Imf::DoubleAttribute(value));
  }
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  std::vector<std::vector<char>> raw;
  raw.reserve(image.channels.size());
  Imf::FrameBuffer buffer;
  for (const NamedPlane& channel : image.channels) {
    const std::size_t bytes = channel.type == PixelType::kHalf ? 2 : 4;
    std::vector<char>& data = raw.emplace_back(bytes * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      char* at = data.data() + bytes * i;
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
    header.channels().insert(channel.name, Imf::Channel(imf_type(channel.type)));
    buffer.insert(channel.name, Imf::Slice(imf_type(channel.type), data.data(), bytes,
                                           bytes * static_cast<std::size_t>(image.width)));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(image.height);
}

std::string one_line(const char* text) {
  std::string line = text;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return line;
}

}  // namespace

const Plane* ExrFile::find(std::string_view name) const {
  for (const NamedPlane& channel : channels) {
    if (channel.name == name) return &channel.data;
  }
  return nullptr;
}

Result<ExrFile> read_exr(const std::filesystem::path& path, const ExrReadLimits& limits) {
  const std::string name = path.string();
  std::error_code status;
  const std::uintmax_t file_bytes = std::filesystem::file_size(path, status);
  if (status) {
    return fail(ErrorCode::kIo, "{}: cannot be read ({})", name, status.message());
  }
  try {
    // OpenEXR's own check, before it makes room for the table of chunks.
    static const bool capped = (Imf::Header::setMaxImageSize(kMaxSide, kMaxSide),
                                Imf::Header::setMaxTileSize(kMaxSide, kMaxSide), true);
    static_cast<void>(capped);
    if (!Imf::isOpenExrFile(path.c_str())) {
      return fail(ErrorCode::kData, "{}: is not an OpenEXR image (wrong first bytes)", name);
    }
    Imf::MultiPartInputFile input(path.c_str(), 0, false);
    SPOOL_ASSIGN(ExrFile file, checked_geometry(name, input.header(0), file_bytes, limits));
    read_attributes(input.header(0), file);
    Imf::InputPart part(input, 0);
    read_pixels(part, file);
    return file;
  } catch (const std::exception& error) {
    return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged ({})", name,
                one_line(error.what()));
  }
}

Result<void> write_exr(const std::filesystem::path& path, const ExrFile& image,
                       const ExrWriteOptions& options) {
  SPOOL_TRY(check_writable(path.string(), image));
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(path, options.overwrite));
  try {
    write_pixels(file.temporary_path(), image);
  } catch (const std::exception& error) {
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): nothing was changed", path.string(),
                one_line(error.what()));
  }
  return file.commit();
}

ExrFile exr_from_rgb(const RgbImage& rgb) {
  ExrFile file;
  file.width = rgb[0].width();
  file.height = rgb[0].height();
  file.channels = {{"R", PixelType::kFloat, rgb[0]},
                   {"G", PixelType::kFloat, rgb[1]},
                   {"B", PixelType::kFloat, rgb[2]}};
  return file;
}

Result<RgbImage> rgb_from_exr(const ExrFile& file, std::string_view name) {
  const Plane* red = file.find("R");
  const Plane* green = file.find("G");
  const Plane* blue = file.find("B");
  if (red && green && blue) return RgbImage{*red, *green, *blue};
  const Plane* grey = file.find("Y");
  if (!grey && file.channels.size() == 1) grey = &file.channels.front().data;
  if (grey) return RgbImage{*grey, *grey, *grey};
  return fail(ErrorCode::kData, "{}: has neither the channels R, G, B nor Y", name);
}

}  // namespace spool
