#include "lib/core/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/core.h>

namespace spool {
namespace {

// What was called otherwise in version 0.1.0, and is called now.
constexpr std::pair<std::string_view, std::string_view> kRenamed[] = {{"K", "levels"}};

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  for (const auto& [before, now] : kRenamed) {
    if (word == before && std::ranges::find(candidates, now) != candidates.end())
      return std::string(now);
  }
  for (const std::string& candidate : candidates)
    if (!word.empty() && candidate.starts_with(word)) return candidate;
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

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string near = nearest_name(word, candidates);
  return near.empty() ? near : fmt::format(", did you mean '{}'?", near);
}

std::string unknown_name(std::string_view what, std::string_view word,
                         const std::vector<std::string>& candidates, std::string_view otherwise) {
  const std::string hint = did_you_mean(word, candidates);
  return fmt::format("unknown {} '{}'{}", what, word, hint.empty() ? otherwise : hint);
}

}  // namespace spool
