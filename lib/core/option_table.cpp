#include "lib/core/option_table.h"

#include <charconv>
#include <cmath>

namespace spool {

Result<double> parse_number(std::string_view name, std::string_view text, double lowest,
                            double highest) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || std::isnan(value)) {
    return fail(ErrorCode::kUsage, "option {}: '{}' is not a number", name, text);
  }
  if (value < lowest || value > highest) {
    return fail(ErrorCode::kUsage, "option {}: {} is outside {}", name, text,
                number_range(lowest, highest));
  }
  return value;
}

Result<int> parse_integer(std::string_view name, std::string_view text, int lowest, int highest) {
  int value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool too_large = code == std::errc::result_out_of_range;
  if ((code != std::errc{} && !too_large) || end != text.data() + text.size()) {
    return fail(ErrorCode::kUsage, "option {}: '{}' is not a whole number", name, text);
  }
  if (too_large || value < lowest || value > highest) {
    return fail(ErrorCode::kUsage, "option {}: {} is outside {} .. {}", name, text, lowest,
                highest);
  }
  return value;
}

std::string format_number(double value) {
  return fmt::format("{}", value);
}

std::string number_range(double lowest, double highest) {
  return fmt::format("{} .. {}", lowest, highest);
}

}  // namespace spool
