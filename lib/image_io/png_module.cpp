// The one file that uses OpenImageIO; built as a module that png_writer.cpp opens on demand.
#include <cstdio>
#include <exception>
#include <memory>

#include <OpenImageIO/imageio.h>

// Writes 8-bit sRGB pixels [y][x][c], c = R, G, B. Returns 0, or 1 with a text in `error`.
extern "C" int spool_write_png(const char* path, int width, int height, const unsigned char* rgb,
                               char* error, std::size_t error_bytes) {
  try {
    // The writer is named, not guessed from `path`, which is a temporary name.
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT8, rgb) &&
        output->close()) {
      return 0;
    }
    std::snprintf(error, error_bytes, "%s",
                  output ? output->geterror().c_str() : OIIO::geterror().c_str());
  } catch (const std::exception& failure) {
    std::snprintf(error, error_bytes, "%s", failure.what());
  }
  return 1;
}
