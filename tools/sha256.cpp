#include "tools/sha256.h"

#include <array>
#include <cstdio>
#include <memory>
#include <vector>

#include <openssl/evp.h>

namespace spool::tools {

Result<std::string> sha256_of_file(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest(EVP_MD_CTX_new(),
                                                                  EVP_MD_CTX_free);
  if (!file) return fail(ErrorCode::kIo, "{}: cannot be read", path.string());
  std::vector<unsigned char> buffer(std::size_t{1} << 20);
  bool good = digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) == 1;
  std::size_t n = buffer.size();
  while (good && n == buffer.size()) {  // a short read is the end, or an error
    n = std::fread(buffer.data(), 1, buffer.size(), file.get());
    good = EVP_DigestUpdate(digest.get(), buffer.data(), n) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned int bytes = 0;
  good = good && std::ferror(file.get()) == 0 &&
         EVP_DigestFinal_ex(digest.get(), hash.data(), &bytes) == 1;
  if (!good) return fail(ErrorCode::kIo, "{}: cannot be read to its end", path.string());
  std::string text;
  for (unsigned int i = 0; i < bytes; ++i)
    text += fmt::format("{:02x}", hash[i]);
  return text;
}

}  // namespace spool::tools
