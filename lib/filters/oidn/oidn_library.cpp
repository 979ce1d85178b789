#include "lib/filters/oidn/oidn_library.h"

#include <cstdlib>
#include <filesystem>

#include <dlfcn.h>
#include <oneapi/tbb/global_control.h>

namespace spool {
namespace {

constexpr int kCpuDevice = 1, kFloat3 = 3;
constexpr const char* kRemedy =
    "pip install pyoidn, for example, and let SPOOL_OIDN name the "
    "libOpenImageDenoise.so in it";

std::vector<std::string> places() {
  const std::vector<std::string> names = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                                          "libOpenImageDenoise.so"};
  const char* chosen = std::getenv("SPOOL_OIDN");
  if (chosen == nullptr || *chosen == '\0') return names;
  std::error_code status;
  if (!std::filesystem::is_directory(chosen, status)) return {chosen};
  std::vector<std::string> files;
  for (const std::string& name : names)
    files.push_back((std::filesystem::path(chosen) / name).string());
  return files;
}

// The first of `names` that the library has; `missing` keeps the first name that it has not.
template <class Function>
void find(const OidnLibrary& library, Function& function, std::initializer_list<const char*> names,
          std::string& missing) {
  for (const char* name : names) {
    function = reinterpret_cast<Function>(::dlsym(library.handle.get(), name));
    if (function != nullptr) return;
  }
  if (missing.empty()) missing = *names.begin();
}

// The first function that is missing; empty when all are there.
std::string find_functions(OidnLibrary& o) {
  std::string missing;
  find(o, o.new_device, {"oidnNewDevice"}, missing);
  find(o, o.set_device_bool, {"oidnSetDeviceBool", "oidnSetDevice1b"}, missing);
  find(o, o.set_device_int, {"oidnSetDeviceInt", "oidnSetDevice1i"}, missing);
  find(o, o.commit_device, {"oidnCommitDevice"}, missing);
  find(o, o.get_device_error, {"oidnGetDeviceError"}, missing);
  find(o, o.release_device, {"oidnReleaseDevice"}, missing);
  find(o, o.new_filter, {"oidnNewFilter"}, missing);
  find(o, o.set_shared_filter_image, {"oidnSetSharedFilterImage"}, missing);
  find(o, o.set_filter_bool, {"oidnSetFilterBool", "oidnSetFilter1b"}, missing);
  find(o, o.set_filter_int, {"oidnSetFilterInt", "oidnSetFilter1i"}, missing);
  find(o, o.commit_filter, {"oidnCommitFilter"}, missing);
  find(o, o.execute_filter, {"oidnExecuteFilter"}, missing);
  find(o, o.release_filter, {"oidnReleaseFilter"}, missing);
  o.has_quality = ::dlsym(o.handle.get(), "oidnSetFilterInt") != nullptr;
  return missing;
}

using Handle = std::shared_ptr<void>;

struct Input {
  const char* name;
  std::vector<float>* values;
};

class Run {
 public:
  Run(const OidnLibrary& library, const OidnImages& images, const OidnSettings& settings)
      : library_(library), images_(images), settings_(settings) {
    device_ = Handle(library.new_device(kCpuDevice), [&](void* d) {
      if (d != nullptr) library_.release_device(d);
    });
    if (device_ == nullptr) return;
    library.set_device_int(device_.get(), "numThreads", threads());
    library.set_device_bool(device_.get(), "setAffinity", false);  // this program has threads, too
    library.commit_device(device_.get());
  }

  // Reads `inputs` and overwrites the first of them.
  Result<void> execute(const std::vector<Input>& inputs, bool hdr, bool exact_features) const {
    if (device_ == nullptr) return failed();
    const Handle filter(library_.new_filter(device_.get(), "RT"), [&](void* f) {
      if (f != nullptr) library_.release_filter(f);
    });
    if (filter == nullptr) return failed();
    for (const Input& input : inputs)
      set_image(filter.get(), input.name, *input.values);
    set_image(filter.get(), "output", *inputs.front().values);
    if (hdr) library_.set_filter_bool(filter.get(), "hdr", true);
    if (exact_features) library_.set_filter_bool(filter.get(), "cleanAux", true);
    if (library_.has_quality) {
      library_.set_filter_int(filter.get(), "quality", static_cast<int>(settings_.quality));
    }
    library_.commit_filter(filter.get());
    library_.execute_filter(filter.get());
    return failed();
  }

 private:
  static int threads() {
    return static_cast<int>(oneapi::tbb::global_control::active_value(
        oneapi::tbb::global_control::max_allowed_parallelism));
  }

  void set_image(void* filter, const char* name, std::vector<float>& values) const {
    library_.set_shared_filter_image(filter, name, values.data(), kFloat3, images_.width,
                                     images_.height, 0, 0, 0);
  }

  // What the library has to say; nothing when all went well.
  Result<void> failed() const {
    const char* message = nullptr;
    const int code = library_.get_device_error(device_.get(), &message);
    if (code == 0 && device_ != nullptr) return {};
    return fail(ErrorCode::kData, "filter oidn: Open Image Denoise: {}",
                message == nullptr ? "no device" : message);
  }

  const OidnLibrary& library_;
  const OidnImages& images_;
  OidnSettings settings_;
  Handle device_;
};

}  // namespace

Result<std::shared_ptr<const OidnLibrary>> open_oidn() {
  std::string why;
  for (const std::string& place : places()) {
    auto library = std::make_shared<OidnLibrary>();
    void* handle = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      const char* said = ::dlerror();
      if (why.empty()) why = said == nullptr ? place : said;
      continue;
    }
    library->handle = Handle(handle, [](void* h) { ::dlclose(h); });
    const std::string missing = find_functions(*library);
    if (missing.empty()) return std::shared_ptr<const OidnLibrary>(std::move(library));
    return fail(ErrorCode::kUsage, "{}: has no function {}: {}", place, missing, kRemedy);
  }
  return fail(ErrorCode::kUsage, "Open Image Denoise is not here ({}): {}", why, kRemedy);
}

Result<std::vector<float>> run_oidn(const OidnLibrary& library, OidnImages images,
                                    const OidnSettings& settings) {
  const Run run(library, images, settings);
  std::vector<Input> inputs = {{"color", &images.colour}};
  if (!images.albedo.empty()) inputs.push_back({"albedo", &images.albedo});
  if (!images.normal.empty()) inputs.push_back({"normal", &images.normal});
  const bool prefilter = settings.prefilter && inputs.size() > 1;
  for (std::size_t i = 1; prefilter && i < inputs.size(); ++i)
    SPOOL_TRY(run.execute({inputs[i]}, false, false));
  SPOOL_TRY(run.execute(inputs, true, prefilter));
  return std::move(images.colour);
}

}  // namespace spool
