#include "formats/interchange/sha256.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include <openssl/evp.h>

#include "formats/open_dump.h"
#include "formats/record_layout.h"

namespace spool::interchange {

namespace {

// A part of a file, from `begin` up to `end`.
struct Part {
  uint64_t begin = 0, end = 0;
};

Result<std::string> sha256_of_parts(const format::FileHandle& file,
                                    std::initializer_list<Part> parts) {
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest(EVP_MD_CTX_new(),
                                                                  EVP_MD_CTX_free);
  bool good = digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) == 1;
  std::vector<std::byte> buffer(size_t{1} << 20);
  for (const Part& part : parts) {
    for (uint64_t at = part.begin; good && at < part.end;) {
      const auto count = static_cast<size_t>(std::min<uint64_t>(buffer.size(), part.end - at));
      SPOOL_TRY(file.read_at(at, std::span(buffer).first(count)));
      good = EVP_DigestUpdate(digest.get(), buffer.data(), count) == 1;
      at += count;
    }
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

}  // namespace

Result<std::string> sha256_of(const format::FileHandle& file) {
  SPOOL_ASSIGN(const uint64_t bytes, file.size());
  return sha256_of_parts(file, {{0, bytes}});
}

Result<std::string> sha256_of(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const format::FileHandle file,
               format::FileHandle::open(path, format::OpenMode::kRead));
  return sha256_of(file);
}

Result<std::string> index_sha256_of(const std::filesystem::path& path) {
  SPOOL_ASSIGN(const format::OpenDump dump, format::open_dump(path));
  return sha256_of_parts(dump.file,
                         {{0, format::kUnit}, {dump.footer.index_offset, dump.file_bytes}});
}

}  // namespace spool::interchange
