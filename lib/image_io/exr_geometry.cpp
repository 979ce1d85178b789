#include "lib/image_io/exr_geometry.h"

#include <algorithm>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>

namespace spool::exr {

void cap_sizes() {
  // OpenEXR's own check, before it makes room for the table of chunks.
  static const bool capped = (Imf::Header::setMaxImageSize(kMaxSide, kMaxSide),
                              Imf::Header::setMaxTileSize(kMaxSide, kMaxSide), true);
  static_cast<void>(capped);
}

Result<Window> checked_window(const std::string& name, const Imf::Header& header,
                              std::uint64_t max_pixels) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return fail(ErrorCode::kData, "{}: the data window is {} x {} pixels: the file is not usable",
                name, width, height);
  }
  const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > max_pixels) {
    return fail(ErrorCode::kData, "{}: {} x {} pixels are more than the limit of {}", name, width,
                height, max_pixels);
  }
  return Window{static_cast<int>(width), static_cast<int>(height)};
}

Result<std::vector<ExrChannel>> checked_channels(const std::string& name,
                                                 const Imf::Header& header) {
  std::vector<ExrChannel> channels;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    const std::string_view text = i.name();
    if (std::any_of(text.begin(), text.end(), [](char c) { return c < ' ' && c >= 0; }) ||
        text.empty()) {
      return fail(ErrorCode::kDamage, "{}: the name of channel {} is no text: the file is damaged",
                  name, channels.size());
    }
    const Imf::PixelType type = i.channel().type;
    channels.push_back({i.name(),
                        type == Imf::HALF
                            ? PixelType::kHalf
                            : (type == Imf::UINT ? PixelType::kUint : PixelType::kFloat),
                        i.channel().xSampling != 1 || i.channel().ySampling != 1});
  }
  if (channels.empty()) return fail(ErrorCode::kData, "{}: has no channels", name);
  return channels;
}

Result<void> check_full_size(const std::string& name, const ExrChannel& channel) {
  if (!channel.subsampled) return {};
  return fail(ErrorCode::kData, "{}: channel {} is subsampled: write it at full size", name,
              channel.name);
}

Result<void> check_claim(const std::string& name, const Window& window, std::size_t channels,
                         std::uint64_t claimed, std::uint64_t max_bytes, std::uint64_t file_bytes) {
  if (claimed > max_bytes) {
    return fail(ErrorCode::kData, "{}: {} channels of {} x {} pixels exceed the limit of {} bytes",
                name, channels, window.width, window.height, max_bytes);
  }
  if (claimed / kMaxExpansion > file_bytes) {
    return fail(ErrorCode::kDamage,
                "{}: claims {} channels of {} x {} pixels in {} bytes: the file is cut or damaged",
                name, channels, window.width, window.height, file_bytes);
  }
  return {};
}

void read_attributes(const Imf::Header& header, ExrAttributes& attributes) {
  for (auto i = header.begin(); i != header.end(); ++i) {
    const Imf::Attribute& attribute = i.attribute();
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
      attributes.texts[i.name()] = text->value();
    } else if (const auto* real = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) {
      attributes.numbers[i.name()] = real->value();
    } else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) {
      attributes.numbers[i.name()] = static_cast<double>(single->value());
    } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&attribute)) {
      attributes.numbers[i.name()] = integer->value();
    }
  }
}

void write_attributes(const ExrAttributes& attributes, Imf::Header& header) {
  for (const auto& [key, value] : attributes.texts)
    header.insert(key, Imf::StringAttribute(value));
  for (const auto& [key, value] : attributes.numbers)
    header.insert(key, Imf::DoubleAttribute(value));
}

Imf::PixelType imf_type(PixelType type) {
  return type == PixelType::kHalf ? Imf::HALF : (type == PixelType::kUint ? Imf::UINT : Imf::FLOAT);
}

}  // namespace spool::exr
