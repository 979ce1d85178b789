// What png_module.cpp does, with libpng alone: for packages that bring all they need.
#include <cstdio>
#include <vector>

#include <png.h>

// As in png_module.cpp.
extern "C" int spool_make_png(int width, int height, const unsigned char* rgb,
                              void (*take)(void* context, const unsigned char* png,
                                           std::size_t bytes),
                              void* context, char* error, std::size_t error_bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  // At most the size of the pixels, deflated badly, and of the headers of their chunks.
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<unsigned char> png(bytes);
  if (png_image_write_to_memory(&image, png.data(), &bytes, 0, rgb, 0, nullptr) != 0) {
    take(context, png.data(), bytes);
    return 0;
  }
  std::snprintf(error, error_bytes, "%s", image.message);
  return 1;
}
