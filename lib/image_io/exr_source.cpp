#include "lib/image_io/exr_source.h"

#include <algorithm>
#include <numeric>

#include <exception>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include "lib/core/visible_text.h"
#include "lib/image_io/exr_geometry.h"
#include "lib/image_io/exr_header_scan.h"

namespace spool {
namespace {

bool is_flat(const Imf::Header& header) {
  return !header.hasType() || header.type() == Imf::SCANLINEIMAGE ||
         header.type() == Imf::TILEDIMAGE;
}

ExrWindow window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, std::int64_t{box.max.x} - box.min.x + 1,
          std::int64_t{box.max.y} - box.min.y + 1};
}

// B44 changes halves only, PXR24 floats only.
const char* lossy_compression(const Imf::Header& header) {
  bool half = false, single = false;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    half = half || i.channel().type == Imf::HALF;
    single = single || i.channel().type == Imf::FLOAT;
  }
  switch (header.compression()) {
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return half ? "B44" : "";
    case Imf::PXR24_COMPRESSION:
      return single ? "PXR24" : "";
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return "DWA";
    default:
      return "";
  }
}

Result<ExrPart> part_of(const std::string& name, const Imf::Header& header) {
  ExrPart part;
  if (header.hasName()) part.name = header.name();
  if (header.hasType()) part.type = header.type();
  if (header.hasView()) part.view = header.view();
  if (Imf::hasMultiView(header)) part.views = Imf::multiView(header);
  part.lossy = lossy_compression(header);
  part.flat = is_flat(header);
  part.data = window_of(header.dataWindow());
  part.display = window_of(header.displayWindow());
  SPOOL_ASSIGN(part.channels, exr::checked_channels(name, header));
  exr::read_attributes(header, part.attributes);
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities& given = Imf::chromaticities(header);
    std::array<double, 8>& numbers = part.chromaticities.emplace();
    std::size_t at = 0;
    for (const Imath::V2f& point : {given.red, given.green, given.blue, given.white}) {
      numbers[at++] = static_cast<double>(point.x);
      numbers[at++] = static_cast<double>(point.y);
    }
  }
  return part;
}

tl::unexpected<Error> damaged(const std::string& name, const std::exception& error) {
  return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged ({})", name,
              printable_ascii(error.what()));
}

}  // namespace

tl::unexpected<Error> not_flat(const std::string& file, const std::vector<ExrPart>& parts,
                               std::size_t part) {
  const std::string& type = parts[part].type;
  return fail(ErrorCode::kData, "{}: part {} is '{}', {}: a flat image is needed", file, part, type,
              type.starts_with("deep") ? "a deep EXR" : "which is unknown here");
}

struct ExrSource::State {
  State(const std::filesystem::path& path, std::uint64_t bytes, const ExrReadLimits& caps)
      : name(path.string()), file_bytes(bytes), limits(caps), input(path.c_str(), 0, false) {}

  std::string name;
  std::uint64_t file_bytes;
  ExrReadLimits limits;
  Imf::MultiPartInputFile input;
  std::vector<ExrPart> parts;

  // The planes of a part, with room for their values.
  Result<std::vector<ExrPlane>> plan(std::size_t p,
                                     const std::vector<std::size_t>& channels) const {
    const ExrPart& part = parts[p];
    if (!part.flat) return not_flat(name, parts, p);
    SPOOL_ASSIGN(const exr::Window window,
                 exr::checked_window(name, input.header(static_cast<int>(p)), limits.max_pixels));
    const auto pixels =
        static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
    const std::uint64_t claimed = pixels * channels.size() * sizeof(double);  // as the cap counts
    SPOOL_TRY(
        exr::check_claim(name, window, channels.size(), claimed, limits.max_bytes, file_bytes));
    std::vector<ExrPlane> planes;
    for (const std::size_t c : channels) {
      const ExrChannel& channel = part.channels[c];
      SPOOL_TRY(exr::check_full_size(name, channel));
      planes.push_back({channel.name, channel.type,
                        std::vector<std::byte>(pixels * bytes_per_value(channel.type))});
    }
    return planes;
  }

  // Of chunks without compression OpenEXR takes what its memory held for bytes that are not there;
  // only of a file of one part, in lines, it looks at their sizes itself.
  Result<void> check_plain_chunks(std::size_t p) {
    const int number = static_cast<int>(p);
    const Imf::Header& header = input.header(number);
    std::int64_t pixel_bytes = 0;
    bool subsampled = false;
    for (const ExrChannel& channel : parts[p].channels) {
      pixel_bytes += static_cast<std::int64_t>(bytes_per_value(channel.type));
      subsampled = subsampled || channel.subsampled;
    }
    if (header.compression() != Imf::NO_COMPRESSION || subsampled) return {};
    const char* values = nullptr;
    int bytes = 0;
    const auto check = [&](const ExrWindow& window) -> Result<void> {
      const std::int64_t wanted = window.width * window.height * pixel_bytes;
      if (bytes == wanted) return {};
      return fail(ErrorCode::kDamage,
                  "{}: the EXR is cut or damaged (the chunk at {},{} has {} bytes of {})", name,
                  window.x0, window.y0, bytes, wanted);
    };
    const bool tiled = header.hasType() && header.type() == Imf::TILEDIMAGE;
    if (!tiled && parts.size() == 1) return {};
    Imf::InputPart part(input, number);
    const Imath::Box2i& all = header.dataWindow();
    const std::int64_t width = tiled ? header.tileDescription().xSize : parts[p].data.width;
    const std::int64_t height = tiled ? header.tileDescription().ySize : 1;
    int row = 0;
    for (std::int64_t y = all.min.y; y <= all.max.y; ++row, y += height) {
      int column = 0;
      for (std::int64_t x = all.min.x; x <= all.max.x; ++column, x += width) {
        int at_x = column, at_y = row, level_x = 0, level_y = 0;
        if (tiled) {
          part.rawTileData(at_x, at_y, level_x, level_y, values, bytes);
        } else {
          part.rawPixelData(static_cast<int>(y), values, bytes);
        }
        SPOOL_TRY(
            check({x, y, std::min(width, all.max.x - x + 1), std::min(height, all.max.y - y + 1)}));
      }
    }
    return {};
  }

  void read_values(std::size_t p, std::vector<ExrPlane>& planes) {
    Imf::InputPart part(input, static_cast<int>(p));
    const Imath::Box2i& window = part.header().dataWindow();
    Imf::FrameBuffer buffer;
    for (ExrPlane& plane : planes) {
      const std::size_t bytes = bytes_per_value(plane.type);
      buffer.insert(plane.name,
                    Imf::Slice::Make(exr::imf_type(plane.type), plane.values.data(), window, bytes,
                                     bytes * static_cast<std::size_t>(parts[p].data.width)));
    }
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
  }
};

ExrSource::ExrSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
ExrSource::ExrSource(ExrSource&&) noexcept = default;
ExrSource& ExrSource::operator=(ExrSource&&) noexcept = default;
ExrSource::~ExrSource() = default;

const std::string& ExrSource::name() const {
  return state_->name;
}

const std::vector<ExrPart>& ExrSource::parts() const {
  return state_->parts;
}

Result<ExrSource> ExrSource::open(const std::filesystem::path& path, const ExrReadLimits& limits) {
  const std::string name = path.string();
  SPOOL_ASSIGN(const std::uint64_t file_bytes, exr::scan_headers(path));
  try {
    exr::cap_sizes();
    auto state = std::make_unique<State>(path, file_bytes, limits);
    for (int p = 0; p < state->input.parts(); ++p) {
      SPOOL_ASSIGN(ExrPart part, part_of(name, state->input.header(p)));
      state->parts.push_back(std::move(part));
    }
    return ExrSource(std::move(state));
  } catch (const std::exception& error) {
    return damaged(name, error);
  }
}

Result<std::vector<ExrPlane>> ExrSource::read(std::size_t part,
                                              const std::vector<std::size_t>& channels) {
  SPOOL_ASSIGN(std::vector<ExrPlane> planes, state_->plan(part, channels));
  try {
    SPOOL_TRY(state_->check_plain_chunks(part));
    state_->read_values(part, planes);
    return planes;
  } catch (const std::exception& error) {
    return damaged(state_->name, error);
  }
}

Result<std::vector<ExrPlane>> ExrSource::read_all(std::size_t part) {
  std::vector<std::size_t> channels(parts()[part].channels.size());
  std::iota(channels.begin(), channels.end(), std::size_t{0});
  return read(part, channels);
}

Result<void> ExrSource::check_single_part() const {
  if (parts().size() == 1) return {};
  return fail(ErrorCode::kData, "{}: has {} parts: an image of one part is needed", name(),
              parts().size());
}

}  // namespace spool
