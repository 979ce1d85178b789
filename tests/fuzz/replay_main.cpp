// Runs a fuzz target on given files and folders, and on `--random N` inputs that are always the
// same.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/formats/made_dump.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

using namespace spool::format;

size_t replay_file(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  return 1;
}

size_t replay_path(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return replay_file(path);
  size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.is_regular_file()) count += replay_file(entry.path());
  }
  return count;
}

size_t replay_random(uint64_t inputs) {
  for (uint64_t i = 0; i < inputs; ++i) {
    std::vector<uint8_t> data(mix(i) % 600);
    for (size_t k = 0; k < data.size(); ++k)
      data[k] = static_cast<uint8_t>(mix(i << 20 | k));
    LLVMFuzzerTestOneInput(data.data(), data.size());
  }
  return inputs;
}

}  // namespace

int main(int argc, char** argv) {
  size_t count = 0;
  for (int i = 1; i < argc; ++i) {
    const bool random = std::string_view(argv[i]) == "--random" && i + 1 < argc;
    count += random ? replay_random(std::strtoull(argv[++i], nullptr, 10)) : replay_path(argv[i]);
  }
  std::printf("%zu inputs\n", count);
  return count > 0 ? 0 : 1;
}
