// Bytes -> an EXR file. What the scan of its headers lets through, OpenEXR reads or refuses with
// memory in proportion to the file (run with -malloc_limit_mb=256): the scan and OpenEXR find the
// same attributes at the same places.
#include <algorithm>
#include <fstream>

#include "lib/image_io/deep_exr_file.h"
#include "lib/image_io/exr_source.h"
#include "lib/image_io/foreign_picture.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool;
  const std::filesystem::path& path = format::fuzz_file("in");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto one_line = [](const Error& error) {
    format::demand(error.message.find('\n') == std::string::npos, "an error is one line");
  };
  if (const auto picture = read_picture(path); !picture) one_line(picture.error());
  if (auto source = ExrSource::open(path)) {
    for (std::size_t p = 0; p < std::min<std::size_t>(source->parts().size(), 8); ++p)
      if (const auto planes = source->read(p, {0}); !planes) one_line(planes.error());
  }
  if (auto deep = DeepExrReader::open(path); !deep) {
    one_line(deep.error());
  } else if (const auto row = deep->read_row(0); !row) {
    one_line(row.error());
  }
  return 0;
}
