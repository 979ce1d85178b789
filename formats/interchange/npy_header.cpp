#include "formats/interchange/npy_header.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "formats/byte_io.h"

namespace spool::interchange {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

// One pass over the literal; every function eats leading blanks and reports success.
class Literal {
 public:
  explicit Literal(std::string_view text) : text_(text) {}

  bool eat(char c) {
    skip_blanks();
    if (text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool eat_word(std::string_view word) {
    skip_blanks();
    if (!text_.starts_with(word)) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  std::optional<std::string> string() {
    skip_blanks();
    if (text_.empty() || (text_.front() != '\'' && text_.front() != '"')) return std::nullopt;
    const size_t end = text_.find(text_.front(), 1);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view inside = text_.substr(1, end - 1);
    const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '\\'; };
    if (!std::all_of(inside.begin(), inside.end(), plain)) return std::nullopt;
    text_.remove_prefix(end + 1);
    return std::string(inside);
  }
  std::optional<uint64_t> number() {
    skip_blanks();
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc()) return std::nullopt;
    text_.remove_prefix(static_cast<size_t>(end - text_.data()));
    eat('L');  // Python 2 wrote 64L
    return value;
  }
  std::optional<std::vector<uint64_t>> tuple() {
    if (!eat('(')) return std::nullopt;
    std::vector<uint64_t> values;
    while (!eat(')')) {
      const auto value = number();
      if (!value || values.size() == 32) return std::nullopt;  // numpy has at most 32 axes
      values.push_back(*value);
      if (!eat(',')) {
        if (values.size() == 1 || !eat(')')) return std::nullopt;  // (3) is not a tuple
        break;
      }
    }
    return values;
  }
  bool at_list() {
    skip_blanks();
    return !text_.empty() && text_.front() == '[';
  }
  bool at_end() {
    skip_blanks();
    return text_.empty();
  }

 private:
  void skip_blanks() {
    while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\n'))
      text_.remove_prefix(1);
  }
  std::string_view text_;
};

struct Dictionary {
  std::optional<std::string> descr;
  std::optional<bool> fortran_order;
  std::optional<std::vector<uint64_t>> shape;
  bool structured = false;
};

std::optional<Dictionary> parse_dictionary(std::string_view text) {
  Literal literal(text);
  Dictionary found;
  if (!literal.eat('{')) return std::nullopt;
  while (!literal.eat('}')) {
    const auto key = literal.string();
    if (!key || !literal.eat(':')) return std::nullopt;
    if (*key == "descr" && !found.descr) {
      if (literal.at_list()) {
        found.structured = true;
        return found;
      }
      found.descr = literal.string();
      if (!found.descr) return std::nullopt;
    } else if (*key == "fortran_order" && !found.fortran_order) {
      if (literal.eat_word("False"))
        found.fortran_order = false;
      else if (literal.eat_word("True"))
        found.fortran_order = true;
      else
        return std::nullopt;
    } else if (*key == "shape" && !found.shape) {
      found.shape = literal.tuple();
      if (!found.shape) return std::nullopt;
    } else {
      return std::nullopt;
    }
    if (!literal.eat(',')) {
      if (!literal.eat('}')) return std::nullopt;
      break;
    }
  }
  if (!literal.at_end() || !found.descr || !found.fortran_order || !found.shape)
    return std::nullopt;
  return found;
}

}  // namespace

uint64_t NpyHeader::item_bytes() const {
  if (type.size() < 3) return 0;
  uint64_t count = 0;
  const auto [end, error] = std::from_chars(type.data() + 2, type.data() + type.size(), count);
  if (error != std::errc() || end != type.data() + type.size() || count > 65536) return 0;
  return type[1] == 'U' ? 4 * count : count;
}

Result<NpyHeader> parse_npy_header(std::span<const std::byte> start, std::string_view name) {
  const auto damaged = [&](std::string_view what) {
    return fail(ErrorCode::kDamage, "{}: {} (array header): fetch the file again", name, what);
  };
  if (start.size() < 10 || std::memcmp(start.data(), kMagic.data(), kMagic.size()) != 0)
    return damaged("not a .npy array");
  const int major = std::to_integer<int>(start[6]);
  if (major < 1 || major > 3)
    return fail(ErrorCode::kData, "{}: version {} of .npy is unknown here: save with numpy.savez",
                name, major);
  const size_t prefix = major == 1 ? 10 : 12;
  if (start.size() < prefix) return damaged("header is cut");
  const uint64_t length =
      major == 1 ? format::load<uint16_t>(start, 8) : format::load<uint32_t>(start, 8);
  if (length > start.size() - prefix) return damaged("header is cut");
  const std::string_view text(reinterpret_cast<const char*>(start.data()) + prefix,
                              static_cast<size_t>(length));
  const auto found = parse_dictionary(text);
  if (!found) return damaged("header is not the dict of descr, fortran_order and shape");
  if (found->structured)
    return fail(ErrorCode::kData, "{}: structured array: save one array per layer", name);
  const std::string& type = *found->descr;
  if (type.find('O') != std::string::npos)
    return fail(ErrorCode::kData,
                "{}: object arrays are pickles and are never loaded: save plain numbers", name);
  if (type.starts_with('>'))
    return fail(ErrorCode::kData, "{}: big-endian array: save with astype('<{}')", name,
                type.substr(1));
  if (*found->fortran_order && found->shape->size() > 1)
    return fail(ErrorCode::kData, "{}: Fortran order: use np.ascontiguousarray", name);
  NpyHeader header{type, *found->shape, prefix + length};
  if ((type[0] != '<' && type[0] != '|') || header.item_bytes() == 0) {
    return fail(ErrorCode::kData, "{}: dtype {} is not taken: save with astype('<f4')", name, type);
  }
  return header;
}

std::string format_npy_header(std::string_view type, std::span<const uint64_t> shape) {
  std::string axes;
  for (size_t i = 0; i < shape.size(); ++i)
    axes += fmt::format("{}{}", i == 0 ? "" : " ", shape[i]) + (i + 1 < shape.size() ? "," : "");
  if (shape.size() == 1) axes += ",";
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, axes);
  text.append(63 - (10 + text.size()) % 64, ' ');
  text += '\n';
  std::string header(kMagic);
  header +=
      {'\1', '\0', static_cast<char>(text.size() & 0xFF), static_cast<char>(text.size() >> 8)};
  return header + text;
}

}  // namespace spool::interchange
