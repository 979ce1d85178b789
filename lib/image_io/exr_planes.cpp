#include "lib/image_io/exr_planes.h"

#include <exception>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>

#include "lib/core/visible_text.h"
#include "lib/image_io/atomic_file.h"
#include "lib/image_io/exr_geometry.h"
#include "lib/image_io/exr_output.h"
#include "lib/image_io/exr_source.h"

namespace spool {
namespace {

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
  SPOOL_ASSIGN(ExrSource source, ExrSource::open(path, limits));
  SPOOL_TRY(source.check_single_part());
  const ExrPart& part = source.parts().front();
  ExrPlanes image;
  SPOOL_ASSIGN(image.planes, source.read_all(0));
  image.width = static_cast<int>(part.data.width);
  image.height = static_cast<int>(part.data.height);
  image.attributes = part.attributes;
  image.lossy = part.lossy;
  return image;
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
                printable_ascii(error.what()));
  }
  SPOOL_TRY(stream.finished());
  return file.commit();
}

}  // namespace spool
