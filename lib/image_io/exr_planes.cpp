#include "lib/image_io/exr_planes.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_geometry.h"
#include "lib/image_io/exr_header_scan.h"
#include "lib/image_io/exr_output.h"

namespace spool {
namespace {

bool is_flat(const Imf::Header& header) {
  return !header.hasType() || header.type() == Imf::SCANLINEIMAGE ||
         header.type() == Imf::TILEDIMAGE;
}

bool has_rec709_primaries(const Imf::Header& header) {
  if (!Imf::hasChromaticities(header)) return true;
  const Imf::Chromaticities given = Imf::chromaticities(header), rec709;
  const auto near = [](const Imath::V2f& a, const Imath::V2f& b) {
    return std::abs(a.x - b.x) < 1e-3f && std::abs(a.y - b.y) < 1e-3f;
  };
  return near(given.red, rec709.red) && near(given.green, rec709.green) &&
         near(given.blue, rec709.blue) && near(given.white, rec709.white);
}

// The planes of a part, with room for their values.
Result<std::vector<ExrPlane>> plan_part(const std::string& name, const Imf::Header& header,
                                        const exr::Window& window, std::uint64_t max_bytes,
                                        std::uint64_t file_bytes) {
  SPOOL_ASSIGN(const auto channels, exr::checked_channels(name, header));
  const auto pixels =
      static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
  const std::uint64_t claimed = pixels * channels.size() * sizeof(double);  // as the cap counts
  SPOOL_TRY(exr::check_claim(name, window, channels.size(), claimed, max_bytes, file_bytes));
  std::vector<ExrPlane> planes;
  for (const ExrChannel& channel : channels)
    planes.push_back({channel.name, channel.type,
                      std::vector<std::byte>(pixels * bytes_per_value(channel.type))});
  return planes;
}

void read_values(Imf::InputPart& part, int width, std::vector<ExrPlane>& planes) {
  const Imath::Box2i& window = part.header().dataWindow();
  Imf::FrameBuffer buffer;
  for (ExrPlane& plane : planes) {
    const std::size_t bytes = bytes_per_value(plane.type);
    buffer.insert(plane.name,
                  Imf::Slice::Make(exr::imf_type(plane.type), plane.values.data(), window, bytes,
                                   bytes * static_cast<std::size_t>(width)));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
}

Result<ExrPlanes> read_parts(const std::string& name, Imf::MultiPartInputFile& input,
                             const ExrReadLimits& limits, std::uint64_t file_bytes) {
  ExrPlanes image;
  std::uint64_t left = limits.max_bytes;
  for (int p = 0; p < std::min(input.parts(), limits.max_parts); ++p) {
    const Imf::Header& header = input.header(p);
    if (!is_flat(header)) {
      return fail(ErrorCode::kData, "{}: a deep EXR (part {} is '{}'): a flat image is needed",
                  name, p, exr::one_line(header.type()));
    }
    SPOOL_ASSIGN(const exr::Window window, exr::checked_window(name, header, limits.max_pixels));
    const Imath::V2i origin = header.dataWindow().min;
    if (p == 0) {
      image.width = window.width;
      image.height = window.height;
      image.x0 = origin.x;
      image.y0 = origin.y;
    } else if (window.width != image.width || window.height != image.height ||
               origin.x != image.x0 || origin.y != image.y0) {
      return fail(ErrorCode::kData,
                  "{}: part {} has another data window than part 0: save them alike", name, p);
    }
    image.rec709 = image.rec709 && has_rec709_primaries(header);
    exr::read_attributes(header, image.attributes);
    SPOOL_ASSIGN(auto planes, plan_part(name, header, window, left, file_bytes));
    left -= planes.size() * sizeof(double) * static_cast<std::uint64_t>(window.width) *
            static_cast<std::uint64_t>(window.height);
    Imf::InputPart part(input, p);
    read_values(part, window.width, planes);
    for (ExrPlane& plane : planes) {
      if (p > 0 && header.hasName() && plane.name.find('.') == std::string::npos)
        plane.name = header.name() + "." + plane.name;
      image.planes.push_back(std::move(plane));
    }
  }
  return image;
}

Imf::Compression imf_compression(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::kZip:
      return Imf::ZIP_COMPRESSION;
    case ExrCompression::kRunLengths:
      return Imf::RLE_COMPRESSION;
    case ExrCompression::kNone:
      return Imf::NO_COMPRESSION;
  }
  return Imf::ZIP_COMPRESSION;
}

}  // namespace

Result<ExrPlanes> read_exr_planes(const std::filesystem::path& path, const ExrReadLimits& limits) {
  const std::string name = path.string();
  SPOOL_ASSIGN(const std::uint64_t file_bytes, exr::scan_headers(path));
  try {
    exr::cap_sizes();
    Imf::MultiPartInputFile input(path.c_str(), 0, false);
    return read_parts(name, input, limits, file_bytes);
  } catch (const std::exception& error) {
    return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged ({})", name,
                exr::one_line(error.what()));
  }
}

Result<void> write_exr_planes(const std::filesystem::path& path, const ExrPlanes& image,
                              const ExrWriteOptions& options) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(path, options.overwrite, options.shared));
  exr::ExrOutput stream(file.file());
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = imf_compression(options.compression);
    exr::write_attributes(image.attributes, header);
    Imf::FrameBuffer buffer;
    for (const ExrPlane& plane : image.planes) {
      const std::size_t bytes = bytes_per_value(plane.type);
      header.channels().insert(plane.name, Imf::Channel(exr::imf_type(plane.type)));
      // OpenEXR takes a pointer it may write through, and does not.
      auto* values = const_cast<char*>(reinterpret_cast<const char*>(plane.values.data()));
      buffer.insert(plane.name, Imf::Slice(exr::imf_type(plane.type), values, bytes,
                                           bytes * static_cast<std::size_t>(image.width)));
    }
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
  } catch (const std::exception& error) {
    SPOOL_TRY(stream.finished());
    return fail(ErrorCode::kIo, "{}: cannot be written ({}): nothing was changed", path.string(),
                exr::one_line(error.what()));
  }
  SPOOL_TRY(stream.finished());
  return file.commit();
}

}  // namespace spool
