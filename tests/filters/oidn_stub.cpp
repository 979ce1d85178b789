// A library with the functions of Open Image Denoise that the filter calls. It denoises nothing:
// its result says what it was handed.
//
//   with a colour   colour + 1/4 albedo + 1/16 normal, + 64 unless hdr, + 128 if features are exact
//   without one     half of the image (a feature that is denoised by itself)
//
// With SPOOL_OIDN_STUB=fail an execution is an error, with =dim 31/32 of the colour are left.
// SPOOL_OIDN_STUB_VERSION_1: names of version 1.
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

namespace {

struct StubImage {
  float* values = nullptr;
  std::size_t size = 0;
};

struct StubFilter {
  std::map<std::string, StubImage> images;
  std::map<std::string, int> settings;
  bool committed = false;
};

const char* error = nullptr;

float value(const StubFilter& filter, const char* name, std::size_t i) {
  const auto found = filter.images.find(name);
  return found == filter.images.end() ? 0.0f : found->second.values[i];
}

}  // namespace

#ifdef SPOOL_OIDN_STUB_VERSION_1
#define STUB_NAME(version_2, version_1) version_1
#else
#define STUB_NAME(version_2, version_1) version_2
#endif

extern "C" {

void* oidnNewDevice(int type) {
  return type == 1 ? std::malloc(1) : nullptr;
}
void STUB_NAME(oidnSetDeviceBool, oidnSetDevice1b)(void*, const char*, bool) {}
void STUB_NAME(oidnSetDeviceInt, oidnSetDevice1i)(void*, const char* name, int number) {
  if (std::strcmp(name, "numThreads") != 0 || number < 1) error = "threads are not a number";
}
void oidnCommitDevice(void*) {}
int oidnGetDeviceError(void*, const char** message) {
  if (message != nullptr) *message = error;
  const int code = error == nullptr ? 0 : 2;
  error = nullptr;
  return code;
}
void oidnReleaseDevice(void* device) {
  std::free(device);
}
void* oidnNewFilter(void*, const char* type) {
  return std::strcmp(type, "RT") == 0 ? new StubFilter : nullptr;
}
void oidnSetSharedFilterImage(void* filter, const char* name, void* values, int format,
                              std::size_t width, std::size_t height, std::size_t, std::size_t,
                              std::size_t) {
  if (format != 3) error = "not three floats";
  static_cast<StubFilter*>(filter)->images[name] = {static_cast<float*>(values),
                                                    3 * width * height};
}
void STUB_NAME(oidnSetFilterBool, oidnSetFilter1b)(void* filter, const char* name, bool on) {
  static_cast<StubFilter*>(filter)->settings[name] = on;
}
void STUB_NAME(oidnSetFilterInt, oidnSetFilter1i)(void* filter, const char* name, int number) {
  static_cast<StubFilter*>(filter)->settings[name] = number;
}
void oidnCommitFilter(void* filter) {
  static_cast<StubFilter*>(filter)->committed = true;
}
void oidnExecuteFilter(void* filter) {
  StubFilter& stub = *static_cast<StubFilter*>(filter);
  const char* wish = std::getenv("SPOOL_OIDN_STUB");
  if (wish != nullptr && std::strcmp(wish, "fail") == 0) error = "out of patience";
  const bool dim = wish != nullptr && std::strcmp(wish, "dim") == 0;
  if (!stub.committed) error = "not committed";
  const StubImage output = stub.images["output"];
  const bool colour = stub.images.contains("color");
  for (std::size_t i = 0; i < output.size; ++i) {
    if (!colour) {
      output.values[i] *= 0.5f;
      continue;
    }
    output.values[i] = (dim ? 0.96875f : 1.0f) * value(stub, "color", i) +
                       0.25f * value(stub, "albedo", i) + 0.0625f * value(stub, "normal", i) +
                       (stub.settings["hdr"] ? 0.0f : 64.0f) +
                       (stub.settings["cleanAux"] ? 128.0f : 0.0f);
  }
}
void oidnReleaseFilter(void* filter) {
  delete static_cast<StubFilter*>(filter);
}

}  // extern "C"
