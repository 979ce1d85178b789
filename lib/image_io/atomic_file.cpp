#include "lib/image_io/atomic_file.h"

#include <span>
#include <utility>

namespace spool {

Result<void> refuse_existing(const std::filesystem::path& target, bool overwrite) {
  std::error_code status;
  if (!overwrite && std::filesystem::exists(std::filesystem::symlink_status(target, status))) {
    return fail(ErrorCode::kUsage, "{}: exists already: choose another name or give --force",
                target.string());
  }
  return {};
}

AtomicFile::AtomicFile(format::TemporaryFile file, format::Replace replace)
    : file_(std::move(file)), replace_(replace) {}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& target, bool overwrite,
                                      bool shared) {
  SPOOL_TRY(refuse_existing(target, overwrite));
  SPOOL_ASSIGN(format::TemporaryFile file, format::TemporaryFile::create(target));
  using format::Replace;
  return AtomicFile(std::move(file), shared      ? Replace::kAnything
                                     : overwrite ? Replace::kWhatWasHere
                                                 : Replace::kNothing);
}

Result<void> AtomicFile::commit() {
  return file_.publish(replace_);
}

Result<void> write_text_file(const std::filesystem::path& target, std::string_view text,
                             bool overwrite, bool shared) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(target, overwrite, shared));
  SPOOL_TRY(file.file().write_at(0, std::as_bytes(std::span(text))));
  return file.commit();
}

}  // namespace spool
