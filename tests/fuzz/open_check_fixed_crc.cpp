// Raw bytes, all checksums made right -> open, check, read. Without this, inputs die at the first
// CRC.
#include "tests/formats/crc_repair.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool::format;
  const auto& path = fuzz_file("in");
  Bytes file = bytes_of(data, size);
  if (file.size() >= 2 * kUnit) {
    const auto offsets = record_offsets(file);
    // The last bit of the input says whether the index may lie about the headers.
    const bool keep_index = (data[size - 1] & 1) != 0;
    if (!offsets.empty()) seal_all(file, offsets, keep_index);
  }
  write_bytes(path, file);
  read_everything(path);
  return 0;
}
