#include "lib/image_io/exr_output.h"

#include <span>
#include <stdexcept>

namespace spool::exr {

void ExrOutput::write(const char bytes[], int count) {
  const std::span<const char> all(bytes, static_cast<std::size_t>(count));
  const Result<void> put = file_.write_at(at_, std::as_bytes(all));
  if (!put) {
    if (!error_) error_ = put.error();
    throw std::runtime_error(put.error().message);
  }
  at_ += all.size();
}

Result<void> ExrOutput::finished() const {
  if (error_) return tl::unexpected<Error>(*error_);
  return {};
}

}  // namespace spool::exr
