// Open Image Denoise [Oidn], opened at run time: no build needs it, and it is used where it is
// installed.
//
// Looked for: what the environment variable SPOOL_OIDN names (a file, or a folder that holds
// libOpenImageDenoise.so), else libOpenImageDenoise.so.2, .so.1, .so where the system looks for
// libraries. Versions 1.4 to 2.x have the functions used here, some under two names.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lib/core/error.h"

namespace spool {

enum class OidnQuality { kFast = 4, kBalanced = 5, kHigh = 6 };  // as the library numbers them

// The functions by what they are called from version 2 on; the types are those of its header.
struct OidnLibrary {
  std::shared_ptr<void> handle;  // closes the library last
  void* (*new_device)(int type) = nullptr;
  void (*set_device_bool)(void*, const char*, bool) = nullptr;
  void (*set_device_int)(void*, const char*, int) = nullptr;
  void (*commit_device)(void*) = nullptr;
  int (*get_device_error)(void*, const char**) = nullptr;
  void (*release_device)(void*) = nullptr;
  void* (*new_filter)(void*, const char*) = nullptr;
  void (*set_shared_filter_image)(void*, const char*, void*, int format, std::size_t width,
                                  std::size_t height, std::size_t offset, std::size_t pixel_stride,
                                  std::size_t row_stride) = nullptr;
  void (*set_filter_bool)(void*, const char*, bool) = nullptr;
  void (*set_filter_int)(void*, const char*, int) = nullptr;
  void (*commit_filter)(void*) = nullptr;
  void (*execute_filter)(void*) = nullptr;
  void (*release_filter)(void*) = nullptr;
  bool has_quality = true;  // version 1 has one quality
};

// Error kUsage where it is not there or lacks a function, with the remedy.
Result<std::shared_ptr<const OidnLibrary>> open_oidn();

// Images [y][x][3]; a feature that is empty is not used.
struct OidnImages {
  std::size_t width = 0, height = 0;
  std::vector<float> colour;  // radiance, >= 0, of any brightness
  std::vector<float> albedo;  // [0, 1]
  std::vector<float> normal;  // [-1, 1]
};

struct OidnSettings {
  bool prefilter = true;  // features are denoised by themselves first, and then taken as exact
  OidnQuality quality = OidnQuality::kHigh;
};

// The denoised colour. On the CPU, with as many threads as this program may use; an execution gives
// the same bits for any number of them, but other bits on a processor with other vector
// instructions. Error kData with what the library says.
Result<std::vector<float>> run_oidn(const OidnLibrary& library, OidnImages images,
                                    const OidnSettings& settings);

}  // namespace spool
