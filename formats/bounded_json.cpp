#include "formats/bounded_json.h"

#include <sys/stat.h>
#include <span>

#include "formats/file_handle.h"

namespace spool::format {

bool nests_within(std::string_view text, std::size_t depth) {
  std::size_t open = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\0') return false;
    if (in_string) {
      if (c == '\\') ++i;  // whatever follows does not end the string
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++open > depth) return false;
    } else if ((c == ']' || c == '}') && open > 0) {
      --open;
    }
  }
  return true;
}

std::optional<std::string> read_short_text(const std::filesystem::path& path,
                                           std::size_t max_bytes) {
  struct stat found{};  // before it is opened: a pipe would wait
  if (::stat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
  const auto bytes = static_cast<std::uintmax_t>(found.st_size);
  if (bytes > max_bytes) return std::nullopt;
  const Result<FileHandle> file = FileHandle::open(path, OpenMode::kRead);
  std::string text(static_cast<std::size_t>(bytes), '\0');
  if (!file || !file->read_at(0, std::as_writable_bytes(std::span(text)))) return std::nullopt;
  return text;
}

}  // namespace spool::format
