// What OpenEXR writes, into a file of ours: every byte that the system refuses is an error. Its own
// stream writes its last buffer and the table of offsets in destructors, which cannot say so.
#pragma once

#include <OpenEXR/ImfIO.h>
#include <cstdint>
#include <optional>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::exr {

class ExrOutput : public Imf::OStream {
 public:
  explicit ExrOutput(format::FileHandle& file) : Imf::OStream(file.path().c_str()), file_(file) {}

  void write(const char bytes[], int count) override;  // throws, as OpenEXR requires it
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  // The first error; asked when OpenEXR's object is gone.
  Result<void> finished() const;

 private:
  format::FileHandle& file_;
  std::uint64_t at_ = 0;
  std::optional<Error> error_;
};

}  // namespace spool::exr
