// Raw bytes -> open, check, read.
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace spool::format;
  const auto& path = fuzz_file("in");
  write_bytes(path, std::as_bytes(std::span(data, size)));
  read_everything(path);
  return 0;
}
