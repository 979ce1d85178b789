#include "lib/core/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

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
  if (code != std::errc{} || end != text.data() + text.size()) {
    return fail(ErrorCode::kUsage, "option {}: '{}' is not a whole number", name, text);
  }
  if (value < lowest || value > highest) {
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

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t substitute = diagonal + (word[i] == candidate[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({row[j + 1] + 1, row[j] + 1, substitute});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace spool
