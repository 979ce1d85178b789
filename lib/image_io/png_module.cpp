// The one file that uses OpenImageIO; built as a module that png_writer.cpp opens on demand.
#include <cstdio>
#include <exception>
#include <memory>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

// Makes a PNG of 8-bit sRGB pixels [y][x][c], c = R, G, B, in memory (its own writing to files does
// not notice a full disk) and hands it to `take`. Returns 0, or 1 with a text in `error`.
extern "C" int spool_make_png(int width, int height, const unsigned char* rgb,
                              void (*take)(void* context, const unsigned char* png,
                                           std::size_t bytes),
                              void* context, char* error, std::size_t error_bytes) {
  try {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    // Fast rather than small: pictures of noise hardly compress.
    spec.attribute("png:compressionLevel", 1);
    spec.attribute("png:filter", 0x20);  // each pixel less the one above it
    OIIO::Filesystem::IOVecOutput memory;
    OIIO::Filesystem::IOProxy* proxy = &memory;
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    if (output && output->open("memory.png", spec) &&
        output->write_image(OIIO::TypeDesc::UINT8, rgb) && output->close()) {
      take(context, memory.buffer().data(), memory.buffer().size());
      return 0;
    }
    std::snprintf(error, error_bytes, "%s",
                  output ? output->geterror().c_str() : OIIO::geterror().c_str());
  } catch (const std::exception& failure) {
    std::snprintf(error, error_bytes, "%s", failure.what());
  }
  return 1;
}
