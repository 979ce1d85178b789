#include "formats/meta_rules.h"

#include <nlohmann/json.hpp>

#include "formats/record_layout.h"

namespace spool::format {

namespace {

// Accepts or refuses while the parser runs and builds nothing, so that a text costs no more memory
// than its depth.
class DepthLimit {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  bool null() { return true; }
  bool boolean(bool) { return true; }
  bool number_integer(number_integer_t) { return true; }
  bool number_unsigned(number_unsigned_t) { return true; }
  bool number_float(number_float_t, const string_t&) { return true; }
  bool string(string_t&) { return true; }
  bool binary(binary_t&) { return false; }
  bool start_object(size_t) { return ++depth_ <= kMaxMetaDepth; }
  bool start_array(size_t) { return ++depth_ <= kMaxMetaDepth; }
  bool key(string_t&) { return true; }
  bool end_object() { return --depth_ >= 0; }
  bool end_array() { return --depth_ >= 0; }
  bool parse_error(size_t, const std::string&, const nlohmann::json::exception&) { return false; }

 private:
  int depth_ = 0;
};

}  // namespace

Judged<void> check_meta(std::string_view text) {
  using enum FailureClass;
  if (text.size() < kMinMetaBytes || text.size() > kMaxMetaBytes) {
    return violates(kDamaged, "meta has {} bytes, outside {}..{}", text.size(), kMinMetaBytes,
                    kMaxMetaBytes);
  }
  DepthLimit limit;
  // The parser takes a byte 0 for the end of the text.
  if (text.front() != '{' || text.find('\0') != std::string_view::npos ||
      !nlohmann::json::sax_parse(text, &limit)) {
    return violates(kDamaged, "meta is not one JSON object of UTF-8");
  }
  return {};
}

}  // namespace spool::format
