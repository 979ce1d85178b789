// Mistyped names: the nearest known one, and the one sentence that names it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spool {

// The candidate that `word` became when it was renamed, else the first that begins with it, else
// the one closest to it in edit distance; empty when nothing is near.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

// ", did you mean 'NAME'?", or nothing when no candidate is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

// "unknown WHAT 'WORD', did you mean 'NAME'?"; where nothing is near, `otherwise` ends the line.
std::string unknown_name(std::string_view what, std::string_view word,
                         const std::vector<std::string>& candidates,
                         std::string_view otherwise = "");

// The names of entries that have one.
template <class Entries>
std::vector<std::string> names_of(const Entries& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries)
    names.emplace_back(entry.name);
  return names;
}

}  // namespace spool
