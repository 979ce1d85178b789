#include "formats/violation.h"

namespace spool::format {

Error file_error(const std::filesystem::path& file, const Violation& violation) {
  const auto line = [&](ErrorCode code, std::string_view remedy) {
    return Error{code, fmt::format("{}: {}: {}", file.string(), violation.what, remedy)};
  };
  switch (violation.failure) {
    case FailureClass::kNotSpool:
      return line(ErrorCode::kData, "give a .spool file, or import it with `spool pack --from`");
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
