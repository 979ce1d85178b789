#include "formats/violation.h"

#include <string_view>
#include <utility>

namespace spool::format {

namespace {

// What is to be done with a file that is no recording, by what its name says it is.
std::string_view remedy_of(const std::filesystem::path& file) {
  static constexpr std::pair<std::string_view, std::string_view> kRemedies[] = {
      {".xml", "a scene of Mitsuba is recorded by dumps/mitsuba/record.py (docs/recording.md)"},
      {".blend", "a scene of Blender is recorded by dumps/record.sh (docs/recording.md)"},
      {".toml", "a plan is for `spool evaluate`"},
      {".npz", "import it with `spool pack --from npz`"},
      {".npy", "write it with spool.write (docs/formats.md)"},
      {".exr", "import a folder of images with `spool pack --from exr-folder`"},
      {".bcd", "import it with `spool pack --from bcd`"}};
  const std::string extension = file.extension().string();
  for (const auto& [of, remedy] : kRemedies)
    if (extension == of) return remedy;
  return "give a .spool file, or import it with `spool pack --from`";
}

}  // namespace

Error file_error(const std::filesystem::path& file, const Violation& violation) {
  const auto line = [&](ErrorCode code, std::string_view remedy) {
    return Error{code, fmt::format("{}: {}: {}", file.string(), violation.what, remedy)};
  };
  switch (violation.failure) {
    case FailureClass::kNotSpool:
      return line(ErrorCode::kData, remedy_of(file));
    case FailureClass::kUnsupported:
      return line(ErrorCode::kData, "use a newer version of spool");
    case FailureClass::kInvalid:
      return line(ErrorCode::kData, "the program that wrote it broke the format: write it again");
    case FailureClass::kIncomplete:
    case FailureClass::kDamaged:
      break;
  }
  return line(ErrorCode::kDamage, "run `spool recover` to keep what is intact");
}

}  // namespace spool::format
