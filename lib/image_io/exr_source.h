// An OpenEXR file that is open: what the headers of its parts contain, and planes of them on
// demand.
//
// Planes come bit for bit in their own type: a NaN keeps its payload and a half stays a half. Files
// are taken as hostile: sizes are checked against the cap and against the length of the file before
// anything is allocated. deep_exr_file.h has deep scanlines.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool {

class ExrSource {
 public:
  // kIo when the file cannot be opened, kData when it is no EXR or uses what is unknown here,
  // kDamage when its headers make no sense.
  static Result<ExrSource> open(const std::filesystem::path& path,
                                const ExrReadLimits& limits = {});
  ExrSource(ExrSource&&) noexcept;
  ExrSource& operator=(ExrSource&&) noexcept;
  ~ExrSource();

  const std::string& name() const;  // the path, for messages
  const std::vector<ExrPart>& parts() const;
  // Channels of a flat part, by their indices. kData for a deep part, for what is subsampled or too
  // large, kDamage when pixels are missing or do not decode.
  Result<std::vector<ExrPlane>> read(std::size_t part, const std::vector<std::size_t>& channels);
  Result<std::vector<ExrPlane>> read_all(std::size_t part);
  Result<void> check_single_part() const;  // kData where there are several

 private:
  struct State;
  explicit ExrSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// kData: a deep part, or one of a type that is unknown here.
tl::unexpected<Error> not_flat(const std::string& file, const std::vector<ExrPart>& parts,
                               std::size_t part);

}  // namespace spool
