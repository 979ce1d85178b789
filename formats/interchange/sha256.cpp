#include "formats/interchange/sha256.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <openssl/evp.h>

namespace spool::interchange {

Result<std::string> sha256_of(const format::FileHandle& file) {
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest(EVP_MD_CTX_new(),
                                                                  EVP_MD_CTX_free);
  bool good = digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) == 1;
  SPOOL_ASSIGN(const uint64_t bytes, file.size());
  std::vector<std::byte> buffer(size_t{1} << 20);
  for (uint64_t at = 0; good && at < bytes;) {
    const auto count = static_cast<size_t>(std::min<uint64_t>(buffer.size(), bytes - at));
    SPOOL_TRY(file.read_at(at, std::span(buffer).first(count)));
    good = EVP_DigestUpdate(digest.get(), buffer.data(), count) == 1;
    at += count;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned int length = 0;
  if (!good || EVP_DigestFinal_ex(digest.get(), hash.data(), &length) != 1)
    return fail(ErrorCode::kIo, "{}: no SHA-256 (libcrypto refuses it): check the OpenSSL set-up",
                file.path().string());
  std::string text;
  for (const unsigned char byte : std::span(hash).first(length))
    text += fmt::format("{:02x}", byte);
  return text;
}

Result<std::string> sha256_of(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const format::FileHandle file,
               format::FileHandle::open(path, format::OpenMode::kRead));
  return sha256_of(file);
}

}  // namespace spool::interchange
